#include "luxel/solve/matrix/relight_data.h"

namespace luxel::matrix {

std::vector<Rgb> mean_emission_of(const RelightData& data) {
  std::vector<Rgb> mean(data.material_name.size());
  std::vector<float> area(mean.size());
  for (size_t i = 0; i < data.size(); ++i)
    mean[data.material[i]] += data.emission[i] * data.area_m2[i],
        area[data.material[i]] += data.area_m2[i];
  for (size_t m = 0; m < mean.size(); ++m)
    if (area[m] > 0) mean[m] = mean[m] / area[m];
  return mean;
}

}  // namespace luxel::matrix
