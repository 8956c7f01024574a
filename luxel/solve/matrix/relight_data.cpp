#include "luxel/solve/matrix/relight_data.h"

namespace luxel::matrix {

std::vector<Rgb> mean_emission_of(const RelightData& data) {
  return mean_emission_of(data.emission, data.material, data.area_m2, data.material_name.size());
}

}  // namespace luxel::matrix
