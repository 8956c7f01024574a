#include "transport/lights.h"

#include <algorithm>
#include <numeric>

#include "base/check.h"
#include "transport/textured_lights.h"

namespace luxel::transport {
namespace {

/// Pieces of textured lights, in the whole scene and of each triangle.
constexpr size_t kMaxPieces = 16384, kMaxPiecesOfOne = 256;

TriangleLight light_from_triangle(const scene::Scene& scene, uint32_t instance, uint32_t triangle) {
  TriangleLight light;
  const scene::Triangle3 t = scene::world_triangle(scene, instance, triangle);
  light.flipped = determinant(scene.instances[instance].world_from_object) < 0;
  light.a = t.a;
  light.b = light.flipped ? t.c : t.b;
  light.c = light.flipped ? t.b : t.c;
  light.normal = scene::front_normal(scene, instance, triangle);
  light.area_m2 = scene::area_m2(t);
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

/// Splits [first, first + count) at the median of the longest axis of the centres, depth first.
void build_node(std::vector<TriangleLight>& lights, std::vector<LightNode>& nodes, uint32_t first,
                uint32_t count) {
  const size_t self = nodes.size();
  nodes.push_back({});
  LightNode node;
  node.first = first, node.count = count;
  Box3 centres;
  for (uint32_t i = first; i < first + count; ++i) {
    const TriangleLight& light = lights[i];
    node.bounds.extend(light.a), node.bounds.extend(light.b), node.bounds.extend(light.c);
    centres.extend((light.a + light.b + light.c) / 3.0f);
    node.power += power_of(light);
  }
  if (count > 1) {
    const Vec3 size = centres.upper - centres.lower;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto begin = lights.begin() + first;
    std::stable_sort(begin, begin + count, [axis](const auto& p, const auto& q) {
      return p.a[axis] + p.b[axis] + p.c[axis] < q.a[axis] + q.b[axis] + q.c[axis];
    });
    build_node(lights, nodes, first, count / 2);
    node.right_child = uint32_t(nodes.size());
    build_node(lights, nodes, first + count / 2, count - count / 2);
  }
  nodes[self] = node;
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
  if (!lights.triangles.empty())
    build_node(lights.triangles, lights.nodes, 0, uint32_t(lights.triangles.size()));
  lights.power_below.assign(1, 0.0f);
  for (const TriangleLight& light : lights.triangles)
    lights.power_below.push_back(lights.power_below.back() + power_of(light));
  return lights;
}

PunctualIncidence incidence_at(const scene::PunctualLight& light,
                               std::span<const scene::LightProfile> profiles, Vec3 position) {
  using Kind = scene::PunctualLight::Kind;
  if (light.kind == Kind::directional) return {light.intensity, -light.direction, INFINITY};
  const Vec3 to_light = light.position - position;
  const float distance = length(to_light);
  if (distance <= 0) return {};
  const Vec3 towards = to_light / distance;
  float factor = 1 / (distance * distance);
  if (light.range_m > 0) {
    const float q = distance / light.range_m;
    factor *= std::clamp(1 - q * q * q * q, 0.0f, 1.0f);
  }
  if (light.kind == Kind::spot) {
    const float c = -dot(towards, light.direction);
    const float outer = std::cos(light.outer_cone_rad), inner = std::cos(light.inner_cone_rad);
    const float t = std::clamp((c - outer) / std::max(1e-3f, inner - outer), 0.0f, 1.0f);
    factor *= t * t;
  }
  if (light.profile != scene::kNone) {
    LUXEL_CHECK(light.profile < profiles.size());
    factor *= scene::candela_at(profiles[light.profile], light.direction, light.side, -towards);
  }
  return {light.intensity * factor, towards, distance};
}

}  // namespace luxel::transport
