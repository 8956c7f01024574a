#include "luxel/light/lights.h"

#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/light/both_punctual_light.h"
#include "luxel/light/punctual_tree.h"
#include "luxel/light/textured_lights.h"
#include "luxel/scene/both_off_surface.h"
#include "luxel/scene/facet.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::light {
namespace {

/// Pieces of textured lights, in the whole scene and of each triangle.
constexpr size_t kMaxPieces = 16384, kMaxPiecesOfOne = 256;

TriangleLight light_from_triangle(const scene::Scene& scene, uint32_t instance, uint32_t triangle) {
  TriangleLight light;
  const scene::Facet facet = scene::facet_of(scene, instance, triangle);
  const scene::Triangle3& t = facet.corners;
  light.flipped = determinant(scene.instances[instance].world_from_object) < 0;
  light.a = t.a;
  light.b = light.flipped ? t.c : t.b;
  light.c = light.flipped ? t.b : t.c;
  light.normal = facet.front;
  light.area_m2 = scene::area_m2(t);
  light.size_m = facet.size_m;
  light.instance = instance, light.triangle = triangle;
  const scene::Material& material = scene::material_at(scene, {instance, triangle, {}});
  light.textured =
      material.emission_texture.texture != scene::kNone || scene::lets_light_through(material);
  light.two_sided = material.double_sided;
  light.mean_radiance = material.emission;  // of textured ones: the largest that it can be
  return light;
}

float power_of(const TriangleLight& light) {
  return luminance(light.mean_radiance) * light.area_m2 * (light.two_sided ? 2.0f : 1.0f);
}

std::vector<TriangleLight> emissive_triangles(const scene::Scene& scene) {
  std::vector<TriangleLight> out;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (max_component(scene.materials[mesh.triangle_material[t]].emission) <= 0) continue;
      const TriangleLight light = light_from_triangle(scene, i, t);
      if (power_of(light) > 0) out.push_back(light);
    }
  }
  return out;
}

/// Two-sided triangles send as much as a sphere of directions does: half of their cosines' mean.
LightLeaf leaf_of(const TriangleLight& light, uint32_t index) {
  LightLeaf leaf;
  leaf.index = index;
  for (const Vec3 p : {light.a, light.b, light.c}) leaf.bounds.extend(p);
  leaf.place = {light.a.x + light.b.x + light.c.x, light.a.y + light.b.y + light.c.y,
                light.a.z + light.b.z + light.c.z};
  leaf.node.power = power_of(light);
  leaf.node.even = light.two_sided ? 0.25f : 0;
  leaf.node.facing = light.two_sided ? Vec3{} : light.normal;
  set_cone(leaf.node, light.normal, light.two_sided ? kPi : 0.5f * kPi);
  return leaf;
}

LightLeaf leaf_of(const scene::PunctualLight& light, std::span<const scene::LightProfile> profiles,
                  uint32_t index) {
  LightLeaf leaf;
  leaf.index = index;
  leaf.place = light.position;
  leaf.bounds.extend(light.position);
  leaf.node.power = luminance(light.intensity);
  if (light.profile != scene::kNone)
    leaf.node.power *= *std::ranges::max_element(profiles[light.profile].candela);
  if (light.range_m > 0) leaf.node.reach_m = light.range_m;
  set_cone(leaf.node, light.direction, scene::has_cone(light.kind) ? light.outer_cone_rad : kPi);
  return leaf;
}

void build_triangle_tree(Lights& lights) {
  std::vector<LightLeaf> leaves;
  for (const TriangleLight& light : lights.triangles)
    leaves.push_back(leaf_of(light, uint32_t(leaves.size())));
  lights.nodes = build_light_tree(leaves);
  std::vector<TriangleLight> sorted;
  for (const LightLeaf& leaf : leaves) sorted.push_back(lights.triangles[leaf.index]);
  lights.triangles = std::move(sorted);
}

/// I / d^2 times the range's window, the ramp between the cones and the candela of the profile.
PunctualIncidence incidence_from_point(const scene::PunctualLight& light,
                                       std::span<const scene::LightProfile> profiles,
                                       Vec3 position) {
  const Vec3 to_light = light.position - position;
  const float distance = length(to_light);
  if (distance <= 0) return {};
  const Vec3 towards = to_light / distance;
  float factor = both::share_at_distance(distance, light.range_m);
  if (scene::has_cone(light.kind))
    factor *= both::share_in_cone(-dot(towards, light.direction), std::cos(light.inner_cone_rad),
                                  std::cos(light.outer_cone_rad));
  if (light.profile != scene::kNone) {
    LUXEL_CHECK(light.profile < profiles.size());
    factor *= scene::candela_at(profiles[light.profile], light.direction, light.side, -towards);
  }
  return {light.intensity * factor, towards, both::reach_of_shadow_ray(distance, light.position)};
}

}  // namespace

Rgb radiance_at(const scene::Scene& scene, const TriangleLight& light, Barycentric at) {
  const auto& part = light.part;
  const float w = 1 - at.u - at.v;
  at = {part[0].u * w + part[1].u * at.u + part[2].u * at.v,
        part[0].v * w + part[1].v * at.u + part[2].v * at.v};
  if (light.flipped) std::swap(at.u, at.v);
  const scene::SurfacePoint p{light.instance, light.triangle, at};
  return scene::emission_at(scene, p) * scene::passage_at(scene, p).coverage;
}

void build_punctual_tree(Lights& lights) {
  std::vector<LightLeaf> leaves;
  lights.punctual_order.clear();
  for (uint32_t i = 0; i < lights.punctual.size(); ++i) {
    if (!scene::has_position(lights.punctual[i].kind)) continue;
    const LightLeaf leaf = leaf_of(lights.punctual[i], lights.profiles, i);
    if (leaf.node.power > 0) leaves.push_back(leaf);
  }
  lights.punctual_nodes = build_light_tree(leaves);
  for (const LightLeaf& leaf : leaves) lights.punctual_order.push_back(leaf.index);
}

Lights collect_lights(const scene::Scene& scene) {
  Lights lights;
  lights.punctual = scene.lights, lights.profiles = scene.profiles;
  lights.around = surroundings_of(scene);
  const std::vector<TriangleLight> whole = emissive_triangles(scene);
  const auto textured = std::count_if(whole.begin(), whole.end(),
                                      [](const TriangleLight& light) { return light.textured; });
  const size_t pieces =
      std::clamp<size_t>(kMaxPieces / std::max<size_t>(1, size_t(textured)), 1, kMaxPiecesOfOne);
  lights.emissive_triangles = whole.size();
  for (const TriangleLight& light : whole) {
    if (!light.textured) {
      lights.triangles.push_back(light);
      continue;
    }
    const std::vector<TriangleLight> parts = pieces_by_brightness(scene, light, pieces);
    lights.triangles.insert(lights.triangles.end(), parts.begin(), parts.end());
  }
  build_triangle_tree(lights);
  build_punctual_tree(lights);
  return lights;
}

PunctualIncidence incidence_at(const scene::PunctualLight& light,
                               std::span<const scene::LightProfile> profiles, Vec3 position) {
  switch (light.kind) {
    case scene::LightKind::directional:
      return {light.intensity, -light.direction, INFINITY};
    case scene::LightKind::point:
    case scene::LightKind::spot:
      return incidence_from_point(light, profiles, position);
  }
  return {};
}

}  // namespace luxel::light
