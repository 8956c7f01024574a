#include "luxel/scene/pieces.h"

#include <optional>

namespace luxel::scene {
namespace {

/// A triangle's corners from the one at `place` on; nothing when it has none there.
std::optional<Corners> corners_from(const Mesh& mesh, const Corners& c, Vec3 place) {
  for (size_t k = 0; k < 3; ++k)
    if (mesh.positions[c[k]] == place) return Corners{c[k], c[(k + 1) % 3], c[(k + 2) % 3]};
  return {};
}

/// Ties the pieces of a triangle to those of its other side, (a, c, b) for (a, b, c).
void tie_pieces(Mesh& mesh, std::span<const uint32_t> pieces, std::span<const uint32_t> others) {
  const auto at = [&](uint32_t v) { return mesh.positions[v]; };
  for (const uint32_t t : pieces) {
    const Corners c = mesh.triangles[t];
    for (const uint32_t o : others) {
      const auto turned = corners_from(mesh, mesh.triangles[o], at(c[0]));
      if (!turned || at((*turned)[1]) != at(c[2]) || at((*turned)[2]) != at(c[1])) continue;
      mesh.triangles[o] = *turned;
      mesh.other_side[t] = o, mesh.other_side[o] = t;
    }
  }
}

}  // namespace

uint32_t append_between(Mesh& mesh, uint32_t low, uint32_t high, float s) {
  const auto between = [&](auto& values) {
    if (!values.empty()) values.push_back(values[low] * (1 - s) + values[high] * s);
  };
  between(mesh.positions), between(mesh.uv0), between(mesh.uv1), between(mesh.colors);
  between(mesh.alphas), between(mesh.normals);
  if (!mesh.normals.empty()) {
    Vec3& n = mesh.normals.back();
    // Normals that point against each other leave none between them.
    n = length(n) > 1e-6f ? normalize(n) : mesh.normals[low];
  }
  return uint32_t(mesh.positions.size() - 1);
}

void PieceWriter::replace(uint32_t triangle, std::span<const Corners> pieces) {
  const bool two_sided = !mesh_.other_side.empty() && mesh_.other_side[triangle] != kNone;
  mesh_.triangles[triangle] = pieces.front();
  if (two_sided) sides_[triangle].push_back(triangle);
  for (const Corners& piece : pieces.subspan(1)) {
    if (two_sided) sides_[triangle].push_back(uint32_t(mesh_.triangles.size()));
    mesh_.triangles.push_back(piece);
    mesh_.triangle_material.push_back(uint32_t(mesh_.triangle_material[triangle]));
    part_of_.push_back(triangle);
  }
}

std::vector<uint32_t> PieceWriter::finish() {
  if (!mesh_.other_side.empty()) mesh_.other_side.resize(mesh_.triangles.size(), kNone);
  if (sides_.empty()) return part_of_;
  const std::vector<uint32_t> before = mesh_.other_side;
  for (const auto& [t, pieces] : sides_)
    if (t < before[t]) tie_pieces(mesh_, pieces, sides_.at(before[t]));
  return part_of_;
}

}  // namespace luxel::scene
