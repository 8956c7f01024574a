#include "luxel/pipeline/solver/field_error.h"

#include "luxel/light/point_error.h"
#include "luxel/transport/covers.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::pipeline {
namespace {

/// Marks those of the texels to check that are covered.
void mark_covered(const light::TexelScene& in, float size_m, std::vector<uint8_t>& left_out) {
  const std::vector<uint32_t> chosen = light::points_to_check(in.elements.size(), left_out);
  const std::vector<float> open =
      transport::open_shares(in.scene, in.tracer, transport::subset(in.elements, chosen), size_m);
  for (size_t k = 0; k < chosen.size(); ++k)
    if (open[k] < 1) left_out[chosen[k]] = 1;
}

}  // namespace

Result<double> field_error(const light::TexelScene& in, const TexelLight& light,
                           const SolvedField& field, const light::DirectParams& direct,
                           Progress& progress) {
  std::vector<uint8_t> left_out = light.hidden;
  mark_covered(in, field.cover_size_m, left_out);
  const std::vector<uint32_t> chosen = light::points_to_check(in.elements.size(), left_out);
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
    return transport::radiosity_at(in.scene, hit.point(), field.irradiance_at);
  };
  LUXEL_TRY(const double error,
            light::point_error({in.scene, in.tracer, in.lights.around, radiosity, direct.seed},
                               in.elements, gathered, left_out, progress));
  return sum > 0 ? error * double(chosen.size()) / sum : 0;
}

}  // namespace luxel::pipeline
