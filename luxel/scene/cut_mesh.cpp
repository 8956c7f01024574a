#include "luxel/scene/cut_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <unordered_map>

#include "luxel/base/check.h"
#include "luxel/base/random.h"
#include "luxel/scene/pieces.h"

namespace luxel::scene {
namespace {

uint64_t key_of(uint32_t low, uint32_t high) { return uint64_t(low) << 32 | high; }

/// Equal for equal positions: the sign of zero does not count.
struct PositionHash {
  size_t operator()(Vec3 p) const {
    const auto bits = [](float x) { return uint64_t(std::bit_cast<uint32_t>(x + 0.0f)); };
    return size_t(hash64(bits(p.x) << 32 | bits(p.y), bits(p.z)));
  }
};

/// Where edges are cut: from the end at the lower place, as a share of the edge. A mesh is cut
/// along hundreds of planes that each cross a small part of it: only the chosen triangles are
/// measured.
class CutEdges {
 public:
  CutEdges(Mesh& mesh, std::span<const uint8_t> chosen, const Plane& plane, double tolerance)
      : mesh_(mesh) {
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
      if (chosen[t]) find_cuts(mesh.triangles[t], plane, tolerance);
  }

  bool empty() const { return at_.empty(); }
  /// False: the triangle has no cut edges. Those have two ends in the box around all of them.
  bool may_cut(const Corners& c) const {
    const auto inside = [&](uint32_t v) {
      const Vec3 p = mesh_.positions[v];
      return max(box_.lower, p) == p && min(box_.upper, p) == p;
    };
    return inside(c[0]) + inside(c[1]) + inside(c[2]) > 1;
  }
  bool cuts(uint32_t a, uint32_t b) const { return share(a, b) != nullptr; }
  /// The vertex on a cut edge; added when it is asked for the first time.
  uint32_t vertex(uint32_t a, uint32_t b) {
    const auto [low, high] = ends(a, b);
    const auto [found, added] = vertex_.emplace(key_of(low, high), 0u);
    if (added) found->second = append_between(mesh_, low, high, *share(a, b));
    return found->second;
  }

 private:
  void find_cuts(const Corners& c, const Plane& plane, double tolerance) {
    std::array<double, 3> height{};
    for (size_t k = 0; k < 3; ++k) height[k] = plane.height(to_double(mesh_.positions[c[k]]));
    for (size_t k = 0; k < 3; ++k) {
      double a = height[k], b = height[(k + 1) % 3];
      if (std::min(a, b) >= -tolerance || std::max(a, b) <= tolerance) continue;
      const auto [low, high] = ends(c[k], c[(k + 1) % 3]);
      if (low != c[k]) std::swap(a, b);
      at_.emplace(key_of(add_place(low), add_place(high)), float(a / (a - b)));
    }
  }

  uint32_t add_place(uint32_t v) {
    box_.extend(mesh_.positions[v]);
    return place_.emplace(mesh_.positions[v], uint32_t(place_.size())).first->second;
  }

  std::pair<uint32_t, uint32_t> ends(uint32_t a, uint32_t b) const {
    return is_lower(mesh_.positions[a], mesh_.positions[b]) ? std::pair(a, b) : std::pair(b, a);
  }

  /// Null where the edge is not cut.
  const float* share(uint32_t a, uint32_t b) const {
    const auto [low, high] = ends(a, b);
    const auto p = place_.find(mesh_.positions[low]), q = place_.find(mesh_.positions[high]);
    if (p == place_.end() || q == place_.end()) return nullptr;
    const auto found = at_.find(key_of(p->second, q->second));
    return found == at_.end() ? nullptr : &found->second;
  }

  Mesh& mesh_;
  std::unordered_map<Vec3, uint32_t, PositionHash> place_;  ///< numbers of ends of cut edges
  Box3 box_;                                                ///< around these
  std::unordered_map<uint64_t, float> at_;                  ///< by places
  std::unordered_map<uint64_t, uint32_t> vertex_;           ///< by vertices
};

/// The pieces of a triangle whose edges (k, k + 1) are cut where cut[k] says, at middle[k].
std::vector<Corners> pieces_of(const Mesh& mesh, const Corners& c, const std::array<bool, 3>& cut,
                               const std::array<uint32_t, 3>& middle) {
  const auto count = std::count(cut.begin(), cut.end(), true);
  if (count == 3)
    return {{c[0], middle[0], middle[2]},
            {middle[0], c[1], middle[1]},
            {middle[2], middle[1], c[2]},
            {middle[0], middle[1], middle[2]}};
  if (count == 1) {
    const size_t k = size_t(std::find(cut.begin(), cut.end(), true) - cut.begin());
    const uint32_t apex = c[(k + 2) % 3];
    return {{c[k], middle[k], apex}, {middle[k], c[(k + 1) % 3], apex}};
  }
  // Two cut edges meet in a corner; what is left is divided by its shorter diagonal, of equal ones
  // by that of the lower place: the other side of a sheet is divided alike.
  const size_t whole = size_t(std::find(cut.begin(), cut.end(), false) - cut.begin());
  const uint32_t a = c[whole], b = c[(whole + 1) % 3], tip = c[(whole + 2) % 3];
  const uint32_t on_b = middle[(whole + 1) % 3], on_a = middle[(whole + 2) % 3];
  const auto apart = [&](uint32_t v, uint32_t w) {
    return length(mesh.positions[v] - mesh.positions[w]);
  };
  const float by_a = apart(a, on_b), by_b = apart(b, on_a);
  const bool a_is_lower = is_lower(mesh.positions[a], mesh.positions[b]);
  if (by_a < by_b || (by_a == by_b && a_is_lower))
    return {{on_a, on_b, tip}, {a, b, on_b}, {a, on_b, on_a}};
  return {{on_a, on_b, tip}, {a, b, on_a}, {b, on_b, on_a}};
}

}  // namespace

Plane plane_in_object(const Plane& world, const Mat34& m) {
  const auto along = [&](int axis) { return dot(world.normal, to_double(column(m, axis))); };
  return {{along(0), along(1), along(2)}, world.offset - along(3)};
}

Mesh& own_mesh(Scene& scene, uint32_t instance) {
  const uint32_t shared = scene.instances[instance].mesh;
  const auto users = std::ranges::count(scene.instances, shared, &Instance::mesh);
  if (users > 1) {
    scene.instances[instance].mesh = uint32_t(scene.meshes.size());
    scene.meshes.push_back(Mesh(scene.meshes[shared]));
  }
  return scene.meshes[scene.instances[instance].mesh];
}

std::vector<uint32_t> cut_mesh(Mesh& mesh, std::span<const uint8_t> chosen, const Plane& plane,
                               double tolerance) {
  LUXEL_CHECK(chosen.size() == mesh.triangles.size());
  CutEdges edges(mesh, chosen, plane, tolerance);
  PieceWriter writer(mesh);
  const size_t count = edges.empty() ? 0 : mesh.triangles.size();
  for (uint32_t t = 0; t < count; ++t) {
    const Corners c = mesh.triangles[t];
    if (!edges.may_cut(c)) continue;
    std::array<bool, 3> cut{};
    std::array<uint32_t, 3> middle{};
    for (size_t k = 0; k < 3; ++k) {
      cut[k] = edges.cuts(c[k], c[(k + 1) % 3]);
      if (cut[k]) middle[k] = edges.vertex(c[k], c[(k + 1) % 3]);
    }
    if (!cut[0] && !cut[1] && !cut[2]) continue;
    writer.replace(t, pieces_of(mesh, c, cut, middle));
  }
  return writer.finish();
}

}  // namespace luxel::scene
