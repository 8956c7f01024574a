#include "luxel/view/draw/surface_corners.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace luxel::view {
namespace {

constexpr std::array<Barycentric, 3> kOwnCorners{{{0, 0}, {1, 0}, {0, 1}}};

/// A part of a triangle of the scene.
struct Part {
  uint32_t instance = 0, triangle = 0;
  std::array<Barycentric, 3> at;
  std::array<uint32_t, 3> element{};
  uint32_t item = 0;
};

SurfaceCorner corner_of(const scene::Scene& scene, const Part& part, size_t k) {
  const scene::Mesh& mesh = scene.meshes[scene.instances[part.instance].mesh];
  const scene::SurfacePoint p{part.instance, part.triangle, part.at[k]};
  const auto& t = mesh.triangles[part.triangle];
  SurfaceCorner out;
  out.position = scene::world_position(scene, p), out.normal = scene::shading_normal(scene, p);
  const auto between = [&](const auto& values) {
    return interpolate(values[t[0]], values[t[1]], values[t[2]], p.at);
  };
  if (!mesh.uv0.empty()) out.uv0 = between(mesh.uv0);
  if (!mesh.uv1.empty()) out.uv1 = between(mesh.uv1);
  if (!mesh.colors.empty()) out.color = between(mesh.colors);
  if (!mesh.alphas.empty()) out.clear = 1 - between(mesh.alphas);
  out.element = part.element[k], out.item = part.item;
  return out;
}

/// Parts by their materials, each material's in their order.
SurfaceCorners by_material(const scene::Scene& scene, std::vector<Part> parts) {
  const auto material = [&](const Part& part) {
    return scene.meshes[scene.instances[part.instance].mesh].triangle_material[part.triangle];
  };
  std::stable_sort(parts.begin(), parts.end(),
                   [&](const Part& a, const Part& b) { return material(a) < material(b); });
  SurfaceCorners out;
  out.corners.reserve(3 * parts.size());
  for (const Part& part : parts) {
    if (out.ranges.empty() || out.ranges.back().material != material(part))
      out.ranges.push_back({material(part), uint32_t(out.corners.size()), 0});
    out.ranges.back().count += 3;
    std::array<SurfaceCorner, 3> corners{corner_of(scene, part, 0), corner_of(scene, part, 1),
                                         corner_of(scene, part, 2)};
    // In the world a mirrored instance's triangles run the other way round.
    if (determinant(scene.instances[part.instance].world_from_object) < 0)
      std::swap(corners[1], corners[2]);
    out.corners.insert(out.corners.end(), corners.begin(), corners.end());
  }
  return out;
}

}  // namespace

SurfaceCorners corners_of(const scene::Scene& scene) {
  std::vector<Part> parts;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t)
      parts.push_back({i, t, kOwnCorners, {}, item_color(uint32_t(parts.size()))});
  return by_material(scene, std::move(parts));
}

SurfaceCorners corners_of(const scene::Scene& scene, const hemicube::Mesh& mesh,
                          const hemicube::Receivers& receivers) {
  std::vector<Part> parts;
  for (uint32_t leaf = 0; leaf < receivers.leaves.size(); ++leaf) {
    const hemicube::Node& node = mesh.nodes[receivers.leaves[leaf]];
    Part& part = parts.emplace_back(
        Part{node.instance, node.triangle, node.at, node.vertex, item_color(leaf)});
    if (receivers.kind == hemicube::ElementKind::triangle) part.element.fill(leaf);
  }
  return by_material(scene, std::move(parts));
}

uint32_t item_color(uint32_t leaf) {
  // Hues go round by the golden ratio, so that numbers near to each other differ.
  const double hue = std::fmod(double(leaf) * 0.6180339887498949, 1.0);
  const double pale = 0.95 - 0.1 * double(leaf % 3);
  uint32_t out = 0;
  for (const double shift : {1 / 3.0, 2 / 3.0, 0.0}) {
    const double away = std::abs(std::fmod(hue + shift, 1.0) * 6 - 3) - 1;
    const double value = 0.4 * pale + 0.6 * std::clamp(away, 0.0, 1.0);
    out = out << 8 | uint32_t(value * 255 + 0.5);
  }
  return out;
}

}  // namespace luxel::view
