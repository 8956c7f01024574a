// NaN and infinity go no further; factors stay in the range that they mean something in.
#include <algorithm>

#include "luxel/scene/held_range.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/scene/origin.h"
#include "luxel/scene/validate_steps.h"

namespace luxel::scene {
namespace {

Status check_positions(const Scene& scene, const Report& report) {
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    const Mesh& mesh = scene.meshes[i];
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3& p = mesh.positions[v];
      if (!is_finite(p))
        return fail(ErrorCode::bad_input,
                    "{}: {}, vertex {}: position ({}, {}, {}) is not finite; repair the mesh",
                    report.file, label("mesh", i, mesh.name), v, p.x, p.y, p.z);
      if (!is_held(p))
        return fail(ErrorCode::bad_input,
                    "{}: {}, vertex {}: position ({}, {}, {}) is too large: coordinates go up to "
                    "{:g} m; repair the vertex or scale the scene down",
                    report.file, label("mesh", i, mesh.name), v, p.x, p.y, p.z, kFarthest_m);
    }
  }
  return {};
}

bool is_finite(const Mat34& m) {
  for (const auto& row : m.row)
    for (const float v : row)
      if (!std::isfinite(v)) return false;
  return true;
}

/// Where an instance's transform puts the vertices of its mesh.
Status check_world(const Scene& scene, const Instance& instance, const std::string& where) {
  const Mesh& mesh = scene.meshes[instance.mesh];
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 p = transform_point(instance.world_from_object, mesh.positions[v]);
    const DVec3 at = in_world(scene, p);
    if (!is_held(p))
      return fail(
          ErrorCode::bad_input,
          "{}: its transform moves {}, vertex {} to ({}, {}, {}): coordinates go up to {:g} m; "
          "move it nearer to the origin or scale the scene down",
          where, label("mesh", instance.mesh, mesh.name), v, at.x, at.y, at.z, kFarthest_m);
  }
  return {};
}

/// A normal's transform has products of two scales in it, and its length their squares.
Status check_scales(const Mat34& m, const std::string& where) {
  const Scales s = scales_of(m);
  if (s.largest_product() <= double(kFarthest_m) * double(kFarthest_m)) return {};
  return fail(
      ErrorCode::bad_input,
      "{}: its transform scales by {:.4g}, {:.4g} and {:.4g}: scales go up to {:g}; enlarge "
      "the mesh instead",
      where, s.x, s.y, s.z, kFarthest_m);
}

Status check_instances(const Scene& scene, const Report& report) {
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const std::string where = report.file + ": " + label("instance", i, instance.name);
    if (!is_finite(instance.world_from_object))
      return fail(ErrorCode::bad_input, "{}: its transform is not finite", where);
    const float density = instance.texel_density;
    if (!(density >= kMinTexelDensity && density <= kMaxTexelDensity))
      return fail(ErrorCode::bad_input, "{}: its density of texels, {}, is outside {} to {}", where,
                  density, kMinTexelDensity, kMaxTexelDensity);
    LUXEL_TRY_STATUS(check_world(scene, instance, where));
    LUXEL_TRY_STATUS(check_scales(instance.world_from_object, where));
  }
  return {};
}

/// Texture coordinates and colours that are no numbers lose only a texel's colour: they are
/// repaired.
void repair_attributes(Scene& scene, Report& report) {
  size_t bad_uvs = 0, bad_colors = 0;
  const auto repair_uv = [&](Vec2& uv) {
    if (std::isfinite(uv.x) && std::isfinite(uv.y)) return;
    uv = {};
    ++bad_uvs;
  };
  const auto repair_color = [&](Rgb& c) {
    if (luxel::is_finite(c) && min_component(c) >= 0) return;
    c = luxel::is_finite(c) ? max(c, Rgb{}) : Rgb{1, 1, 1};
    ++bad_colors;
  };
  const auto repair_alpha = [&](float& alpha) {
    if (alpha >= 0 && alpha <= 1) return;
    alpha = std::isfinite(alpha) ? std::clamp(alpha, 0.0f, 1.0f) : 1;
    ++bad_colors;
  };
  for (Mesh& mesh : scene.meshes) {
    std::for_each(mesh.uv0.begin(), mesh.uv0.end(), repair_uv);
    std::for_each(mesh.uv1.begin(), mesh.uv1.end(), repair_uv);
    std::for_each(mesh.colors.begin(), mesh.colors.end(), repair_color);
    std::for_each(mesh.alphas.begin(), mesh.alphas.end(), repair_alpha);
  }
  if (bad_uvs) report.warn("{} texture coordinates are not finite; set to 0", bad_uvs);
  if (bad_colors)
    report.warn("{} vertex colours are negative or not finite, or alpha above 1; repaired",
                bad_colors);
}

bool is_finite(const TextureRef& ref) {
  for (const float v : {ref.offset.x, ref.offset.y, ref.scale.x, ref.scale.y, ref.rotation})
    if (!std::isfinite(v)) return false;
  return true;
}

Status check_materials(Scene& scene, Report& report) {
  std::vector<std::string> clamped;
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    Material& m = scene.materials[i];
    const std::string name = label("material", i, m.name);
    const bool finite =
        luxel::is_finite(m.base_color) && luxel::is_finite(m.emission) && std::isfinite(m.alpha) &&
        std::isfinite(m.metallic) && std::isfinite(m.roughness) && std::isfinite(m.alpha_cutoff) &&
        luxel::is_finite(m.specular) && std::isfinite(m.sharpness) &&
        std::isfinite(m.normal_scale) && std::isfinite(m.transmission) &&
        std::isfinite(m.diffuse_transmission) && luxel::is_finite(m.diffuse_transmission_color) &&
        std::ranges::all_of(textures_of(m), [](const auto* ref) { return is_finite(*ref); });
    if (!finite)
      return fail(ErrorCode::bad_input, "{}: {}: one of its numbers is not finite", report.file,
                  name);
    // Clamp what can be clamped, and tell whether that has changed anything.
    const Material before = m;
    m.base_color = max(m.base_color, Rgb{});
    m.emission = max(m.emission, Rgb{});
    m.alpha = std::clamp(m.alpha, 0.0f, 1.0f);
    m.metallic = std::clamp(m.metallic, 0.0f, 1.0f);
    m.roughness = std::clamp(m.roughness, 0.0f, 1.0f);
    m.transmission = std::clamp(m.transmission, 0.0f, 1.0f);
    m.diffuse_transmission = std::clamp(m.diffuse_transmission, 0.0f, 1.0f);
    m.diffuse_transmission_color = max(m.diffuse_transmission_color, Rgb{});
    m.specular = max(m.specular, Rgb{});
    m.sharpness = std::max(m.sharpness, 0.0f);
    if (m.base_color != before.base_color || m.emission != before.emission ||
        m.alpha != before.alpha || m.metallic != before.metallic ||
        m.roughness != before.roughness || m.specular != before.specular ||
        m.sharpness != before.sharpness || m.transmission != before.transmission ||
        m.diffuse_transmission != before.diffuse_transmission ||
        m.diffuse_transmission_color != before.diffuse_transmission_color)
      clamped.push_back(name);
  }
  if (!clamped.empty())
    report.warn(
        "factors outside their range clamped (negative colour, emission, specular or "
        "sharpness; alpha, metallic, roughness or transmission outside 0 to 1): {}",
        listed(clamped));
  return {};
}

bool ascends(const std::vector<float>& angles) {
  for (size_t k = 0; k < angles.size(); ++k)
    if (!std::isfinite(angles[k]) || (k > 0 && !(angles[k] > angles[k - 1]))) return false;
  return true;
}

Status check_profiles(const Scene& scene, const Report& report) {
  for (size_t i = 0; i < scene.profiles.size(); ++i) {
    const LightProfile& p = scene.profiles[i];
    const std::string name = label("profile", i, p.name);
    if (p.vertical_rad.size() < 2 || p.horizontal_rad.empty() ||
        p.candela.size() != p.vertical_rad.size() * p.horizontal_rad.size())
      return fail(ErrorCode::bad_input, "{}: {}: {} candela for {} x {} angles", report.file, name,
                  p.candela.size(), p.vertical_rad.size(), p.horizontal_rad.size());
    if (!ascends(p.vertical_rad) || !ascends(p.horizontal_rad))
      return fail(ErrorCode::bad_input, "{}: {}: its angles do not ascend", report.file, name);
    for (const float candela : p.candela)
      if (!(std::isfinite(candela) && candela >= 0))
        return fail(ErrorCode::bad_input, "{}: {}: {} is not a number of candela", report.file,
                    name, candela);
  }
  return {};
}

Status check_lights(Scene& scene, Report& report) {
  LUXEL_TRY_STATUS(check_profiles(scene, report));
  // The background, then each light: numbers, sign, direction.
  if (!luxel::is_finite(scene.background))
    return fail(ErrorCode::bad_input, "{}: the background is not finite", report.file);
  scene.background = max(scene.background, Rgb{});
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    PunctualLight& light = scene.lights[i];
    const std::string name = label("light", i, light.name);
    if (!luxel::is_finite(light.intensity) || !luxel::is_finite(light.position) ||
        !luxel::is_finite(light.direction) || !luxel::is_finite(light.side) ||
        !std::isfinite(light.range_m) || !std::isfinite(light.inner_cone_rad) ||
        !std::isfinite(light.outer_cone_rad) || !std::isfinite(light.angular_radius_rad))
      return fail(ErrorCode::bad_input, "{}: {}: one of its numbers is not finite", report.file,
                  name);
    if (has_position(light.kind) && !is_held(light.position, kFarthestLight_m))
      return fail(
          ErrorCode::bad_input,
          "{}: {}: position ({}, {}, {}) is too large: coordinates of lights go up to {:g} m",
          report.file, name, light.position.x, light.position.y, light.position.z,
          kFarthestLight_m);
    if (min_component(light.intensity) < 0) {
      light.intensity = max(light.intensity, Rgb{});
      report.warn("{}: negative intensity set to 0", name);
    }
    if (!has_direction(light.kind)) continue;
    light.direction = normalize(light.direction);
    if (light.direction == Vec3{})
      return fail(ErrorCode::bad_input, "{}: {}: it has no direction", report.file, name);
  }
  return {};
}

/// The widest picture, of height 1, and the narrowest: beyond, a side would have no pixel.
constexpr float kWidestAspect = 1e4f;

/// True: rays can start from the camera. Its place is held, and so are its axes and the products
/// that tell which way it looks.
bool is_usable(const Camera& camera) {
  const Mat34& m = camera.world_from_camera;
  if (!is_finite(m) || !is_held(column(m, 3)) || scales_of(m).volume == 0) return false;
  for (int axis = 0; axis < 3; ++axis)
    if (!has_unit_vector(column(m, axis))) return false;
  if (camera.aspect != 0 && !(camera.aspect >= 1 / kWidestAspect && camera.aspect <= kWidestAspect))
    return false;
  if (camera.orthographic_height_m > 0) return camera.orthographic_height_m <= kFarthest_m;
  return camera.fov_y_rad > 0 && camera.fov_y_rad < kPi;
}

/// A camera that makes no picture is dropped: the scene can still be lit.
void drop_bad_cameras(Scene& scene, Report& report) {
  std::vector<Camera> kept;
  for (const Camera& camera : scene.cameras) {
    if (is_usable(camera))
      kept.push_back(camera);
    else
      report.warn("camera '{}' has no usable view and is dropped", camera.name);
  }
  scene.cameras = std::move(kept);
}

}  // namespace

std::string listed(const std::vector<std::string>& names) {
  constexpr size_t kShown = 5;
  std::string text;
  for (size_t i = 0; i < std::min(names.size(), kShown); ++i) text += (i ? ", " : "") + names[i];
  if (names.size() > kShown) text += fmt::format(" and {} more", names.size() - kShown);
  return text;
}

Status check_numbers(Scene& scene, Report& report) {
  LUXEL_TRY_STATUS(check_positions(scene, report));
  LUXEL_TRY_STATUS(check_instances(scene, report));
  repair_attributes(scene, report);
  LUXEL_TRY_STATUS(check_materials(scene, report));
  LUXEL_TRY_STATUS(check_lights(scene, report));
  drop_bad_cameras(scene, report);
  return {};
}

}  // namespace luxel::scene
