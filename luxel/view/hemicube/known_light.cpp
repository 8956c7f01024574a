#include "luxel/view/hemicube/known_light.h"

#include "luxel/base/check.h"

namespace luxel::view {

KnownLight begin_known(std::span<const Rgb> reflectance, std::span<const Rgb> irradiance) {
  KnownLight out;
  out.reflectance.assign(reflectance.begin(), reflectance.end());
  out.irradiance.assign(irradiance.begin(), irradiance.end());
  out.has_light = !irradiance.empty();
  out.irradiance.resize(reflectance.size());
  return out;
}

void begin_pass(std::span<const Rgb> direct, KnownLight& light) {
  LUXEL_CHECK(direct.size() == light.irradiance.size());
  if (!light.has_light) light.irradiance.assign(direct.begin(), direct.end());
  light.has_light = true;
  light.sent.resize(light.irradiance.size());
  for (size_t i = 0; i < light.sent.size(); ++i)
    light.sent[i] = light.reflectance[i] * light.irradiance[i];
}

void reach(size_t element, Rgb source, const hemicube::View& view, KnownLight& light) {
  Rgb sum = source;
  for (size_t k = 0; k < view.element.size(); ++k)
    sum += light.sent[view.element[k]] * view.share[k];
  light.irradiance[element] = sum;
}

void take_bounce(std::span<const Rgb> irradiance, KnownLight& light) {
  light.irradiance.assign(irradiance.begin(), irradiance.end());
  light.has_light = true;
}

}  // namespace luxel::view
