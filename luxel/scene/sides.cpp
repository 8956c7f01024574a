#include "luxel/scene/sides.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "luxel/base/check.h"
#include "luxel/scene/position_numbers.h"

namespace luxel::scene {
namespace {

/// Copies of double-sided materials without that flag, made when they are first asked for.
class OneSided {
 public:
  explicit OneSided(Scene& scene) : scene_(scene) {}

  uint32_t of(uint32_t material) {
    if (!scene_.materials[material].double_sided) return material;
    const auto [found, is_new] = copy_.try_emplace(material, uint32_t(scene_.materials.size()));
    if (is_new) {
      scene_.materials.push_back(Material(scene_.materials[material]));
      scene_.materials.back().double_sided = false;
    }
    return found->second;
  }

 private:
  Scene& scene_;
  std::map<uint32_t, uint32_t> copy_;
};

/// A triangle by its places: the lowest of them first, and then the lower of the other two.
struct CornerPositions {
  std::array<uint32_t, 3> sorted{};
  uint32_t triangle = 0;
  uint8_t first_corner = 0;  ///< the corner at sorted[0]
  bool reversed = false;     ///< the places run downwards around the triangle

  friend bool operator<(const CornerPositions& p, const CornerPositions& q) {
    return std::tie(p.sorted, p.triangle) < std::tie(q.sorted, q.triangle);
  }
};

std::vector<CornerPositions> sorted_corner_positions(const Mesh& mesh) {
  const std::vector<uint32_t> place = position_numbers(mesh.positions);
  std::vector<CornerPositions> out(mesh.triangles.size());
  for (uint32_t t = 0; t < out.size(); ++t) {
    std::array<uint32_t, 3> p{};
    for (size_t k = 0; k < 3; ++k) p[k] = place[mesh.triangles[t][k]];
    const size_t first = size_t(std::min_element(p.begin(), p.end()) - p.begin());
    const uint32_t next = p[(first + 1) % 3], last = p[(first + 2) % 3];
    out[t] = {
        {p[first], std::min(next, last), std::max(next, last)}, t, uint8_t(first), next > last};
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// The corners of a triangle from `first` on.
std::array<uint32_t, 3> rotated(const std::array<uint32_t, 3>& corners, size_t first) {
  return {corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]};
}

/// True: both triangles let light through alike. `a` and `b` are their corners at the same places.
bool let_through_alike(const Scene& scene, const Mesh& mesh, uint32_t material_a,
                       uint32_t material_b, const std::array<uint32_t, 3>& a,
                       const std::array<uint32_t, 3>& b) {
  if (!lets_light_through(scene.materials[material_a]) &&
      !lets_light_through(scene.materials[material_b]))
    return true;
  if (material_a != material_b) return false;
  for (size_t k = 0; k < 3; ++k)
    if (!mesh.alphas.empty() && mesh.alphas[a[k]] != mesh.alphas[b[k]]) return false;
  // Only the pictures that say where light goes through count. In a baked file TEXCOORD_1 differs:
  // each side has its own light.
  const auto looked_up_alike = [&](const TextureRef& ref) {
    const std::vector<Vec2>& uv = ref.uv_set == 0 ? mesh.uv0 : mesh.uv1;
    if (ref.texture == kNone || uv.empty()) return true;
    for (size_t k = 0; k < 3; ++k)
      if (!(uv[a[k]] == uv[b[k]])) return false;
    return true;
  };
  const Material& material = scene.materials[material_a];
  return looked_up_alike(material.base_color_texture) &&
         looked_up_alike(material.transmission_texture);
}

/// Ties the two when they are sides of one sheet.
bool link(const Scene& scene, Mesh& mesh, const CornerPositions& p, const CornerPositions& q) {
  if (p.sorted != q.sorted || p.reversed == q.reversed) return false;
  const std::array<uint32_t, 3> a = rotated(mesh.triangles[p.triangle], p.first_corner);
  const std::array<uint32_t, 3> b = rotated(mesh.triangles[q.triangle], q.first_corner);
  if (!let_through_alike(scene, mesh, mesh.triangle_material[p.triangle],
                         mesh.triangle_material[q.triangle], a, {b[0], b[2], b[1]}))
    return false;
  // a is (A, B, C) and b (A, C, B); p's own corners begin first_corner places before A.
  mesh.triangles[q.triangle] = rotated(b, p.first_corner);
  mesh.other_side[p.triangle] = q.triangle, mesh.other_side[q.triangle] = p.triangle;
  return true;
}

size_t link_sides_of(const Scene& scene, Mesh& mesh) {
  const std::vector<CornerPositions> places = sorted_corner_positions(mesh);
  size_t pairs = 0;
  for (size_t i = 0; i + 1 < places.size(); ++i) {
    if (places[i].sorted != places[i + 1].sorted) continue;
    if (mesh.other_side.empty()) mesh.other_side.assign(mesh.triangles.size(), kNone);
    if (!link(scene, mesh, places[i], places[i + 1])) continue;
    ++pairs, ++i;
  }
  if (pairs == 0) mesh.other_side.clear();
  return pairs;
}

template <class T>
void append_copy(std::vector<T>& values, uint32_t of) {
  if (!values.empty()) values.push_back(T(values[of]));
}

}  // namespace

std::optional<SurfacePoint> other_side_of(const Scene& scene, const SurfacePoint& p) {
  const Mesh& mesh = scene.meshes[scene.instances[p.instance].mesh];
  if (mesh.other_side.empty() || mesh.other_side[p.triangle] == kNone) return std::nullopt;
  return SurfacePoint{p.instance, mesh.other_side[p.triangle], {p.at.v, p.at.u}};
}

bool scatters_light(const Scene& scene) {
  return std::ranges::any_of(scene.materials,
                             [](const Material& m) { return m.diffuse_transmission > 0; });
}

size_t link_sides(Scene& scene) {
  OneSided one_sided(scene);
  size_t pairs = 0;
  for (Mesh& mesh : scene.meshes) {
    if (!mesh.other_side.empty()) continue;
    pairs += link_sides_of(scene, mesh);
    for (size_t t = 0; t < mesh.other_side.size(); ++t)
      if (mesh.other_side[t] != kNone)
        mesh.triangle_material[t] = one_sided.of(mesh.triangle_material[t]);
  }
  return pairs;
}

void add_backs(Scene& scene, uint32_t index, std::span<const uint8_t> chosen) {
  Mesh& mesh = scene.meshes[index];
  const uint32_t count = uint32_t(mesh.triangles.size());
  LUXEL_CHECK(chosen.size() == count);
  OneSided one_sided(scene);
  mesh.other_side.resize(count, kNone);
  // Without normals, shading is flat and both sides may share their vertices.
  std::vector<uint32_t> behind(mesh.positions.size(), kNone);
  const auto vertex_behind = [&](uint32_t v) {
    if (mesh.normals.empty()) return v;
    if (behind[v] == kNone) {
      behind[v] = uint32_t(mesh.positions.size());
      append_copy(mesh.positions, v);
      append_copy(mesh.uv0, v);
      append_copy(mesh.uv1, v);
      append_copy(mesh.colors, v);
      append_copy(mesh.alphas, v);
      mesh.normals.push_back(-mesh.normals[v]);
    }
    return behind[v];
  };
  for (uint32_t t = 0; t < count; ++t) {
    if (!chosen[t]) continue;
    LUXEL_CHECK(mesh.other_side[t] == kNone);
    const auto [a, b, c] = mesh.triangles[t];
    mesh.other_side[t] = uint32_t(mesh.triangles.size());
    mesh.other_side.push_back(t);
    mesh.triangles.push_back({vertex_behind(a), vertex_behind(c), vertex_behind(b)});
    mesh.triangle_material[t] = one_sided.of(mesh.triangle_material[t]);
    mesh.triangle_material.push_back(uint32_t(mesh.triangle_material[t]));
  }
}

void make_one_sided(Scene& scene, uint32_t index, std::span<const uint8_t> chosen) {
  Mesh& mesh = scene.meshes[index];
  LUXEL_CHECK(chosen.size() == mesh.triangles.size());
  OneSided one_sided(scene);
  for (size_t t = 0; t < chosen.size(); ++t)
    if (chosen[t]) mesh.triangle_material[t] = one_sided.of(mesh.triangle_material[t]);
}

}  // namespace luxel::scene
