#include "luxel/display/local_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/scene/light_kinds.h"

namespace luxel::display {
namespace {

struct Terms {
  bool ambient, diffuse, specular, per_pixel;
};

Terms terms_of(LocalTechnique technique) {
  switch (technique) {
    case LocalTechnique::c:
      break;
    case LocalTechnique::ca:
      return {true, false, false, false};
    case LocalTechnique::cad:
      return {true, true, false, false};
    case LocalTechnique::cas:
      return {true, false, true, false};
    case LocalTechnique::cads:
      return {true, true, true, false};
    case LocalTechnique::cas_pixel:
      return {true, false, true, true};
    case LocalTechnique::cads_pixel:
      return {true, true, true, true};
  }
  return {false, false, false, false};
}

float saturate(float v) { return std::clamp(v, 0.0f, 1.0f); }
Rgb saturate(Rgb c) { return min(max(c, Rgb{}), Rgb{1, 1, 1}); }

/// A corner of the triangle that was hit: what the paper's vertex shader hands on.
struct Corner {
  Vec3 normal, to_viewer;
};

std::array<Corner, 3> corners_of(const scene::Scene& scene, const trace::Hit& hit,
                                 const Viewer& viewer) {
  constexpr std::array<Barycentric, 3> at{{{0, 0}, {1, 0}, {0, 1}}};
  std::array<Corner, 3> corners;
  for (size_t k = 0; k < 3; ++k) {
    const scene::SurfacePoint p{hit.instance, hit.triangle, at[k]};
    // The paper's meshes have one side. The back of a surface with two is lit as a front.
    const Vec3 n = shading_normal(scene, p);
    corners[k] = {hit.back_face ? -n : n, viewer.from(world_position(scene, p))};
  }
  return corners;
}

LocalSurface surface_at(const scene::Scene& scene, const scene::SurfacePoint& p) {
  const scene::Material& m = material_at(scene, p);
  const std::array<float, 4> c = base_color_at(scene, p);  // alpha is discarded, as in the paper
  return {saturate(Rgb{c[0], c[1], c[2]}), saturate(m.specular), m.sharpness};
}

}  // namespace

LocalLights local_lights(const scene::Scene& scene, const scene::Camera& camera) {
  LocalLights lights;
  for (const scene::PunctualLight& light : scene.lights)
    if (!scene::has_position(light.kind)) {
      lights.direction = normalize(light.direction);
      return lights;
    }
  const Mat34& m = camera.world_from_camera;
  const Vec3 right = normalize(column(m, 0)), up = normalize(column(m, 1));
  const Vec3 back = normalize(column(m, 2));
  lights.direction = normalize(right * 0.4f - up * 0.7f - back * 0.8f);
  return lights;
}

Viewer::Viewer(const scene::Camera& camera)
    : eye(column(camera.world_from_camera, 3)),
      back(normalize(column(camera.world_from_camera, 2))),
      orthographic(camera.orthographic_height_m > 0) {}

Vec3 Viewer::from(Vec3 position) const { return orthographic ? back : normalize(eye - position); }

/// [Rodriguez06, eq. 4.10, 4.21, 4.26, 4.28]. The shaders of sections 5.3.4 to 5.4.3 print R with
/// `vecLightWorld`, which is d = -L, in the place of eq. 4.22's vector towards the light; section
/// 5.3.3 itself warns of that mistake. 2 (N.d) N - d is the mirror direction turned round, and with
/// the saturate() that the print has around N.d it is just -d = L on every surface that is lit: the
/// highlight would look back at the light. R below is eq. 4.22's. The saturate() is kept as what it
/// is for: where N.L <= 0 no light arrives, so none is mirrored.
Rgb local_color(LocalTechnique technique, const LocalSurface& surface, const LocalLights& lights,
                Vec3 normal, Vec3 to_viewer) {
  const Terms terms = terms_of(technique);
  if (!terms.ambient) return saturate(surface.material);
  const Vec3 to_light = -lights.direction;
  const float facing = saturate(dot(normal, to_light));
  Rgb sum = lights.ambient * surface.material;
  if (terms.diffuse) sum += lights.light * surface.material * facing;
  if (terms.specular && facing > 0) {
    const Vec3 mirrored = normal * (2 * facing) - to_light;
    const float highlight =
        std::pow(saturate(dot(normalize(mirrored), to_viewer)), surface.sharpness);
    sum += lights.light * surface.specular * highlight;
  }
  return saturate(sum);
}

Rgb local_light_at(const scene::Scene& scene, const trace::Hit& hit, LocalTechnique technique,
                   const LocalLights& lights, const Viewer& viewer) {
  const LocalSurface surface = surface_at(scene, hit.point());
  if (technique == LocalTechnique::c || technique == LocalTechnique::ca)
    return local_color(technique, surface, lights, {}, {});
  const auto [a, b, c] = corners_of(scene, hit, viewer);
  if (terms_of(technique).per_pixel)
    return local_color(technique, surface, lights,
                       normalize(interpolate(a.normal, b.normal, c.normal, hit.at)),
                       normalize(interpolate(a.to_viewer, b.to_viewer, c.to_viewer, hit.at)));
  return interpolate(local_color(technique, surface, lights, a.normal, a.to_viewer),
                     local_color(technique, surface, lights, b.normal, b.to_viewer),
                     local_color(technique, surface, lights, c.normal, c.to_viewer), hit.at);
}

}  // namespace luxel::display
