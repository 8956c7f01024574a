#include "luxel/scene/brightness.h"

#include <algorithm>

#include "luxel/base/vec_double.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/scene/origin.h"
#include "luxel/scene/validate_steps.h"

namespace luxel::scene {
namespace {

Failure too_bright(const std::string& file, const std::string& what, const std::string& value,
                   float most, const char* remedy) {
  return fail(ErrorCode::bad_input, "{}{}{}: {} is too bright, it may be {:g} at most; {}", file,
              file.empty() ? "" : ": ", what, value, most, remedy);
}

/// Distance from the farthest corner of a box [m].
double farthest_from(const Box3& box, Vec3 p) {
  const DVec3 to_lower = to_double(p) - to_double(box.lower);
  const DVec3 to_upper = to_double(p) - to_double(box.upper);
  return length(DVec3{std::max(std::abs(to_lower.x), std::abs(to_upper.x)),
                      std::max(std::abs(to_lower.y), std::abs(to_upper.y)),
                      std::max(std::abs(to_lower.z), std::abs(to_upper.z))});
}

Status check_light(const Scene& scene, size_t index, const Box3& bounds, const std::string& file) {
  const PunctualLight& light = scene.lights[index];
  const std::string name = label("light", index, light.name);
  const float brightest = brightest_of(scene, light);
  if (!has_position(light.kind)) {
    if (brightest <= kBrightest) return {};
    return too_bright(file, name, fmt::format("an illuminance of {:g}", brightest), kBrightest,
                      "lower its intensity");
  }
  if (!(brightest <= kMostIntensity))
    return too_bright(file, name, fmt::format("an intensity of {:g}", brightest), kMostIntensity,
                      "lower it");
  if (bounds.empty() || brightest == 0) return {};
  double distance_m = farthest_from(bounds, light.position);
  if (light.range_m > 0) distance_m = std::min(distance_m, double(light.range_m));
  const double irradiance = double(brightest) / (distance_m * distance_m);
  if (irradiance <= double(kBrightest)) return {};
  return too_bright(file, name,
                    fmt::format("an intensity of {:g} makes an illuminance of {:g} at {:.3g} m, "
                                "which",
                                brightest, irradiance, distance_m),
                    kBrightest, "lower the intensity");
}

Status check_materials_light(const Scene& scene, const std::string& file) {
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const float l = max_component(scene.materials[i].emission);
    if (!(l <= kBrightest))
      return too_bright(file, label("material", i, scene.materials[i].name),
                        fmt::format("an emission of {:g}", l), kBrightest, "lower its emission");
  }
  return {};
}

Status check_surroundings(const Scene& scene, const std::string& file) {
  if (const float l = max_component(scene.background); !(l <= kBrightest))
    return too_bright(file, "the background", fmt::format("a radiance of {:g}", l), kBrightest,
                      "lower it");
  const Environment& map = scene.environment;
  for (size_t i = 0; i < map.radiance.size(); ++i) {
    const float l = max_component(map.radiance[i]);
    if (!(l <= kBrightest))
      return too_bright(file, "the environment",
                        fmt::format("a radiance of {:g} in pixel ({}, {})", l,
                                    i % size_t(map.width), i / size_t(map.width)),
                        kBrightest, "lower its scale");
  }
  return {};
}

}  // namespace

float brightest_of(const Scene& scene, const PunctualLight& light) {
  float most = max_component(light.intensity);
  if (light.profile != kNone && has_position(light.kind)) {
    const std::vector<float>& candela = scene.profiles[light.profile].candela;
    most *= *std::max_element(candela.begin(), candela.end());
  }
  return most;
}

Error overflow_at(const Scene& scene, Vec3 place) {
  // The irradiance that each light could make there, if all of it came straight.
  double most = -1;
  std::string who;
  const auto consider = [&](double irradiance, const auto& words) {
    if (irradiance > most) most = irradiance, who = words();
  };
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const PunctualLight& light = scene.lights[i];
    const double brightest = double(brightest_of(scene, light));
    const double distance_m = length(to_double(light.position) - to_double(place));
    const std::string name = label("light", i, light.name);
    if (has_position(light.kind))
      consider(brightest / std::max(distance_m * distance_m, 1e-300), [&] {
        return fmt::format(
            "{}, whose intensity of {:g} is {:.3g} m away: lower it, or move it "
            "away from surfaces",
            name, brightest, distance_m);
      });
    else
      consider(brightest,
               [&] { return fmt::format("{}, of illuminance {:g}: lower it", name, brightest); });
  }
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const double l = double(max_component(scene.materials[i].emission));
    consider(kPiDouble * l, [&] {
      return fmt::format("{}, whose emission is {:g}: lower it",
                         label("material", i, scene.materials[i].name), l);
    });
  }
  double around = double(max_component(scene.background));
  for (const Rgb& l : scene.environment.radiance)
    around = std::max(around, double(max_component(l)));
  consider(kPiDouble * around, [&] {
    return fmt::format("the surroundings, whose radiance goes up to {:g}: lower it", around);
  });
  const DVec3 o = scene.origin;
  return {ErrorCode::bad_input, fmt::format("the light at ({}, {}, {}) is above {:g}, "
                                            "too bright to store; most of it can come from {}",
                                            short_number(place.x, o.x), short_number(place.y, o.y),
                                            short_number(place.z, o.z), kMostIrradiance, who)};
}

Status check_held(const Scene& scene, std::span<const Rgb> light,
                  const std::function<Vec3(size_t)>& place) {
  for (size_t i = 0; i < light.size(); ++i)
    if (!is_held_light(light[i])) return Failure{overflow_at(scene, place(i))};
  return {};
}

Status check_brightness(const Scene& scene, const std::string& file) {
  LUXEL_TRY_STATUS(check_materials_light(scene, file));
  LUXEL_TRY_STATUS(check_surroundings(scene, file));
  const Box3 bounds = scene.lights.empty() ? Box3{} : world_bounds(scene);
  for (size_t i = 0; i < scene.lights.size(); ++i)
    LUXEL_TRY_STATUS(check_light(scene, i, bounds, file));
  return {};
}

}  // namespace luxel::scene
