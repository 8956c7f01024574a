#include "luxel/view/model/lamp_change.h"

#include "luxel/scene/light_kinds.h"

namespace luxel::view {

void change(const LampChange& by, DVec3 origin, Lamp& lamp) {
  constexpr float kDegree = kPi / 180;
  scene::PunctualLight& light = lamp.light;
  if (by.to) light.position = to_float(*by.to - origin);
  if (by.direction) light.direction = normalize(*by.direction);
  if (by.intensity) light.intensity = *by.intensity;
  if (by.is_on) lamp.is_on = *by.is_on;
  if (by.cone_deg) light.outer_cone_rad = *by.cone_deg * kDegree;
  if (by.inner_cone_deg) light.inner_cone_rad = *by.inner_cone_deg * kDegree;
  light.inner_cone_rad = std::min(light.inner_cone_rad, light.outer_cone_rad);
  if (by.disc_deg) light.angular_radius_rad = 0.5f * *by.disc_deg * kDegree;
}

Lamp new_lamp(const LampAdded& added, const Box3& bounds, DVec3 origin) {
  Lamp out;
  out.light.kind = added.kind, out.light.position = bounds.centre();
  out.light.name = "new " + std::string(scene::name_of(added.kind));
  change(added.change, origin, out);
  return out;
}

}  // namespace luxel::view
