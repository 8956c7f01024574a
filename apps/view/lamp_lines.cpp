#include "apps/view/lamp_lines.h"

#include "luxel/image/color.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/scene/origin.h"
#include "luxel/scene/sky.h"

namespace luxel::view_window {
namespace {

constexpr float kDegree = kPi / 180;

}  // namespace

std::array<float, 3> numbers(Vec3 v) { return {v.x, v.y, v.z}; }
Vec3 vector(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }
std::array<double, 3> numbers(Vec3 p, DVec3 origin) {
  return {scene::short_number(p.x, origin.x), scene::short_number(p.y, origin.y),
          scene::short_number(p.z, origin.z)};
}
Vec3 vector(const std::array<double, 3>& p, DVec3 origin) {
  return to_float(DVec3{p[0], p[1], p[2]} - origin);
}

void set_light(Rgb light, LampLine& line) {
  line.strength = max_component(light);
  const Rgb c = line.strength > 0 ? light / line.strength : Rgb{1, 1, 1};
  line.color = {image::srgb_from_linear(c.x), image::srgb_from_linear(c.y),
                image::srgb_from_linear(c.z)};
}

Rgb light_of(const LampLine& line) {
  return Rgb{image::linear_from_srgb(line.color[0]), image::linear_from_srgb(line.color[1]),
             image::linear_from_srgb(line.color[2])} *
         line.strength;
}

LampLine line_of(const view::Lamp& lamp, bool is_lux, DVec3 origin) {
  const scene::PunctualLight& light = lamp.light;
  LampLine out;
  out.name = light.name.empty() ? std::string(scene::name_of(light.kind)) : light.name;
  out.is_on = lamp.is_on;
  out.has_place = scene::has_position(light.kind);
  out.has_direction = scene::has_direction(light.kind);
  out.unit = out.has_place ? (is_lux ? "cd" : "W/sr") : (is_lux ? "lux" : "W/m2");
  if (light.profile != scene::kNone) out.unit = "x its profile";
  out.place = numbers(light.position, origin), out.direction = numbers(light.direction);
  out.has_cone = scene::has_cone(light.kind), out.has_disc = !out.has_place;
  out.cone_deg = light.outer_cone_rad / kDegree,
  out.inner_cone_deg = light.inner_cone_rad / kDegree;
  out.disc_deg = 2 * light.angular_radius_rad / kDegree;
  set_light(light.intensity, out);
  return out;
}

void take_line(const LampLine& before, const LampLine& now, DVec3 origin, view::Lamp& lamp) {
  scene::PunctualLight& light = lamp.light;
  lamp.is_on = now.is_on;
  if (now.color != before.color || now.strength != before.strength) light.intensity = light_of(now);
  if (now.place != before.place) light.position = vector(now.place, origin);
  if (now.direction != before.direction && length(vector(now.direction)) > 0)
    light.direction = normalize(vector(now.direction));
  if (now.cone_deg != before.cone_deg) light.outer_cone_rad = now.cone_deg * kDegree;
  if (now.inner_cone_deg != before.inner_cone_deg)
    light.inner_cone_rad = now.inner_cone_deg * kDegree;
  light.inner_cone_rad = std::min(light.inner_cone_rad, light.outer_cone_rad);
  if (now.disc_deg != before.disc_deg) light.angular_radius_rad = 0.5f * now.disc_deg * kDegree;
}

view::LampAdded lamp_to_add(scene::PunctualLight::Kind kind, float exposure, const Box3& bounds) {
  view::LampAdded out;
  out.kind = kind;
  const float distance_m = 0.25f * bounds.diagonal();
  const bool is_sun = !scene::has_position(kind);
  const float strength = kPi / exposure * (is_sun ? 1 : distance_m * distance_m);
  out.change.intensity = Rgb{strength, strength, strength};
  if (!is_sun) return out;
  out.change.direction = Vec3{-0.4f, -0.8f, -0.45f};
  out.change.disc_deg = 2 * scene::kSunAngularRadiusRad / kDegree;
  return out;
}

}  // namespace luxel::view_window
