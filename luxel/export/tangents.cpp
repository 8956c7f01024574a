#include "luxel/export/tangents.h"

#include <cmath>

namespace luxel::export_ {
namespace {

float uv_area(std::span<const Vec2> places, const std::array<uint32_t, 3>& t) {
  return cross(places[t[1]] - places[t[0]], places[t[2]] - places[t[0]]);
}

/// Along growing u, of any length; zero where the coordinates have no area.
Vec3 along_u(const scene::Mesh& mesh, std::span<const Vec2> places,
             const std::array<uint32_t, 3>& t) {
  const float area = uv_area(places, t);
  if (area == 0 || !std::isfinite(area)) return {};
  const Vec3 ab = mesh.positions[t[1]] - mesh.positions[t[0]],
             ac = mesh.positions[t[2]] - mesh.positions[t[0]];
  const float ab_v = places[t[1]].y - places[t[0]].y, ac_v = places[t[2]].y - places[t[0]].y;
  return (ab * ac_v - ac * ab_v) * (area > 0 ? 1.0f : -1.0f);
}

Vec3 unit_or_zero(Vec3 v) {
  const float l = length(v);
  return l > 0 && std::isfinite(l) ? v / l : Vec3{};
}

template <class T>
void append_corners(const std::vector<T>& from, const std::array<uint32_t, 3>& triangle,
                    std::vector<T>& to) {
  if (from.empty()) return;
  for (const uint32_t v : triangle) to.push_back(from[v]);
}

}  // namespace

scene::Mesh with_flat_normals(const scene::Mesh& mesh) {
  scene::Mesh out;
  out.name = mesh.name, out.triangle_material = mesh.triangle_material;
  for (const auto& t : mesh.triangles) {
    const auto first = uint32_t(out.positions.size());
    const Vec3 a = mesh.positions[t[0]];
    const Vec3 n = unit_or_zero(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a));
    append_corners(mesh.positions, t, out.positions);
    append_corners(mesh.uv0, t, out.uv0);
    append_corners(mesh.uv1, t, out.uv1);
    append_corners(mesh.colors, t, out.colors);
    append_corners(mesh.alphas, t, out.alphas);
    out.normals.insert(out.normals.end(), 3, n);
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

std::vector<Vec2> normal_map_places(const scene::Mesh& mesh, const scene::Material& material) {
  const scene::TextureRef& map = material.normal_texture;
  const std::vector<Vec2>& uv = map.uv_set == 1 ? mesh.uv1 : mesh.uv0;
  std::vector<Vec2> out;
  if (map.texture == scene::kNone || mesh.normals.empty()) return out;
  for (const Vec2 at : uv) out.push_back(scene::transformed_uv(map, at));
  return out;
}

// v falls along the picture's height, so coordinates that run counter-clockwise are mirrored.
bool is_mirrored(std::span<const Vec2> places, const std::array<uint32_t, 3>& triangle) {
  return uv_area(places, triangle) > 0;
}

std::vector<std::array<float, 4>> tangents(const scene::Mesh& mesh, std::span<const Vec2> places,
                                           const LightmapVertices& vertices, bool mirrored) {
  std::vector<Vec3> sum(vertices.source.size());
  for (size_t i = 0; i + 2 < vertices.indices.size(); i += 3) {
    std::array<uint32_t, 3> triangle{};
    for (size_t c = 0; c < 3; ++c) triangle[c] = vertices.source[vertices.indices[i + c]];
    const Vec3 u = unit_or_zero(along_u(mesh, places, triangle));
    for (size_t c = 0; c < 3; ++c) sum[vertices.indices[i + c]] += u;
  }
  std::vector<std::array<float, 4>> out;
  for (size_t v = 0; v < sum.size(); ++v) {
    const Vec3 n = unit_or_zero(mesh.normals[vertices.source[v]]);
    const Vec3 flat = sum[v] - n * dot(n, sum[v]);
    const Vec3 t = length(flat) > 1e-4f ? normalize(flat)
                   : n == Vec3{}        ? Vec3{1, 0, 0}
                                        : frame_around(n).tangent;
    out.push_back({t.x, t.y, t.z, mirrored ? -1.0f : 1.0f});
  }
  return out;
}

}  // namespace luxel::export_
