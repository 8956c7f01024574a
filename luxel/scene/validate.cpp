// The chain of checks: references first, because the later ones follow them; then numbers; then the
// triangles, whose area only makes sense on finite numbers.
#include "luxel/scene/validate.h"

#include <fmt/format.h>

#include "luxel/scene/brightness.h"
#include "luxel/scene/validate_steps.h"

namespace luxel::scene {

namespace {

/// Without the reasons, a scene of triangles would be refused for having none.
Failure nothing_left(const Report& report) {
  if (report.losses.empty())
    return fail(ErrorCode::bad_input, "{}: the scene has no triangles; nothing can be lit",
                report.file);
  return fail(ErrorCode::bad_input, "{}: the scene has no triangles left; nothing can be lit: {}",
              report.file, fmt::join(report.losses, "; "));
}

}  // namespace

Result<std::vector<std::string>> validate(Scene& scene, const std::string& file) {
  Report report{file, {}, {}};
  LUXEL_TRY_STATUS(check_references(scene, report));
  LUXEL_TRY_STATUS(check_numbers(scene, report));
  drop_singular_instances(scene, report);
  drop_zero_area_triangles(scene, report);
  warn_of_steps(scene, report);
  repair_normals(scene, report);
  clamp_reflectance(scene, report);
  warn_of_transparent(scene, report);
  for (const Instance& instance : scene.instances)
    if (!scene.meshes[instance.mesh].triangles.empty()) {
      LUXEL_TRY_STATUS(check_brightness(scene, file));
      return std::move(report.warnings);
    }
  return nothing_left(report);
}

bool has_lamp_or_sky(const Scene& scene) {
  if (max_component(scene.background) > 0) return true;
  for (const Rgb& l : scene.environment.radiance)
    if (max_component(l) > 0) return true;
  for (const PunctualLight& light : scene.lights)
    if (max_component(light.intensity) > 0) return true;
  return false;
}

bool has_light(const Scene& scene) {
  if (has_lamp_or_sky(scene)) return true;
  for (const Instance& instance : scene.instances)
    for (const uint32_t material : scene.meshes[instance.mesh].triangle_material)
      if (max_component(scene.materials[material].emission) > 0) return true;
  return false;
}

}  // namespace luxel::scene
