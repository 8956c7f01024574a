#include "luxel/pipeline/solver/field_error.h"

#include "luxel/light/point_error.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::pipeline {

Result<double> field_error(const light::TexelScene& in, const TexelLight& light,
                           const IrradianceAt& irradiance_at, const light::DirectParams& direct,
                           Progress& progress) {
  const std::vector<uint32_t> chosen = light::points_to_check(in.elements.size(), light.hidden);
  LUXEL_TRY(const light::DirectLight straight,
            light::direct_light(in.scene, transport::subset(in.elements, chosen), in.lights,
                                in.tracer, direct, progress));
  std::vector<Rgb> gathered(in.elements.size());
  double sum = 0;
  for (size_t k = 0; k < chosen.size(); ++k) {
    const size_t i = chosen[k];
    gathered[i] = light.irradiance[i] - straight.irradiance[k];
    sum += double(luminance(light.irradiance[i]));
  }
  const auto radiosity = [&](const trace::Hit& hit) {
    return transport::radiosity_at(in.scene, hit.point(), irradiance_at);
  };
  LUXEL_TRY(const double error,
            light::point_error({in.scene, in.tracer, in.lights.around, radiosity, direct.seed},
                               in.elements, gathered, light.hidden, progress));
  return sum > 0 ? error * double(chosen.size()) / sum : 0;
}

}  // namespace luxel::pipeline
