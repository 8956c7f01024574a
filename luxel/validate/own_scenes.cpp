#include "luxel/validate/own_scenes.h"

#include <algorithm>

#include "luxel/base/random.h"
#include "luxel/scene/procedural.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::validate {
namespace {

/// A point just off the surface in the house's own axes; the house is instance 1.
Vec3 in_house(const scene::Scene& scene, const scene::SurfacePoint& p) {
  const Mat34 house = scene.instances[1].world_from_object;
  const Vec3 at =
      scene::world_position(scene, p) + scene::front_normal(scene, p.instance, p.triangle) * 1e-3f;
  return {dot(at, column(house, 0)), dot(at, column(house, 1)), dot(at, column(house, 2))};
}
/// Between the inner faces of the walls, which are 1 cm thick, but for a tenth of a millimetre: the
/// cuts' vertices are floats.
bool is_inside(Vec3 p) {
  return std::abs(p.x) < 1.9899f && std::abs(p.z) < 1.4899f && p.y > 0 && p.y < 2.4f;
}

/// Part of a solution that lies on the floor, instance 0.
struct Floor {
  std::vector<size_t> texels;
  transport::Elements elements;
};
Floor floor_of(const Prepared& p) {
  Floor out;
  for (size_t i = 0; i < p.map.texels.size(); ++i) {
    if (p.map.texels[i].sample.instance != 0) continue;
    out.texels.push_back(i);
    out.elements.position.push_back(p.elements.position[i]);
    out.elements.normal.push_back(p.elements.normal[i]);
    out.elements.geometric_normal.push_back(p.elements.geometric_normal[i]);
    out.elements.reflectance.push_back(p.elements.reflectance[i]);
  }
  return out;
}

void compare_means(std::span<const Rgb> light, const Judged& judged, FoliageLight& out) {
  double brightest = 0;
  for (const Rgb& e : light) brightest = std::max(brightest, double(luminance(e)));
  double solved = 0, exact = 0, solved_in_shadow = 0, exact_in_shadow = 0;
  for (size_t k = 0; k < light.size(); ++k) {
    const double s = double(luminance(light[k])), j = double(luminance(judged.mean(k)));
    solved += s, exact += j;
    if (s > 0.4 * brightest) continue;
    solved_in_shadow += s, exact_in_shadow += j, ++out.in_shadow;
  }
  out.mean = solved / exact, out.shadow_mean = solved_in_shadow / exact_in_shadow;
}

}  // namespace

HouseLight house_light(const pipeline::Bake& bake) {
  HouseLight out;
  int lawn = 0;
  // Texels: the brightest inside, the mean of the lawn.
  for (size_t i = 0; i < bake.map.texels.size(); ++i) {
    const atlas::Texel& t = bake.map.texels[i];
    const float e = luminance(bake.light.irradiance[i]);
    if (is_inside(in_house(bake.scene, t.sample)))
      out.texel = std::max(out.texel, e);
    else if (t.sample.instance == 0 && !bake.light.hidden[i])
      out.lawn += double(e), ++lawn;
  }
  out.lawn /= lawn;
  // Look-ups, as a viewer makes them: the brightest inside.
  const transport::TexelField field{&bake.atlas, &bake.map, bake.light.irradiance};
  for (uint32_t i = 0; i < bake.scene.instances.size(); ++i)
    for (uint32_t t = 0; t < bake.scene.meshes[bake.scene.instances[i].mesh].triangles.size(); ++t)
      for (uint32_t k = 0; k < 2000; ++k) {
        Vec2 u = sobol_owen_2d(k, t);
        if (u.x + u.y > 1) u = {1 - u.x, 1 - u.y};
        const scene::SurfacePoint p{i, t, {u.x, u.y}};
        if (!is_inside(in_house(bake.scene, p))) continue;
        out.lookup = std::max(out.lookup, luminance(transport::irradiance_at(field, p)));
        ++out.lookups;
      }
  return out;
}

Result<FoliageLight> foliage_light(int paths, Progress& progress) {
  scene::Scene scene = scene::foliage();
  scene.lights[0].angular_radius_rad = 0.02f;  // shadows with soft rims
  LUXEL_TRY(const auto prepared, prepare(std::move(scene), 160, progress));
  const Prepared& p = *prepared;
  const Floor floor = floor_of(p);
  LUXEL_TRY(const Judged judged,
            judge(p.scene, *p.tracer, reference::receivers(floor.elements), paths, 1, progress));
  pipeline::BakeSettings settings;
  settings.samples = 1024, settings.direct_samples = 256, settings.seed = 7;
  LUXEL_TRY(const Timed solved, solve(p, "gather", settings, progress));
  std::vector<Rgb> light;
  for (const size_t i : floor.texels) light.push_back(solved.light.irradiance[i]);
  FoliageLight out;
  out.floor = agreement(light, {}, judged);
  out.texels = light.size();
  out.is_two_sided = std::ranges::all_of(p.scene.meshes, [](const scene::Mesh& mesh) {
    return mesh.other_side.empty() == (mesh.name != "twig");
  });
  compare_means(light, judged, out);
  return out;
}

}  // namespace luxel::validate
