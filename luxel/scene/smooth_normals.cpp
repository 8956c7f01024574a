#include "luxel/scene/smooth_normals.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "luxel/base/check.h"
#include "luxel/base/vec_double.h"
#include "luxel/scene/position_numbers.h"

namespace luxel::scene {
namespace {

/// Normals that differ by less are one: float positions of a flat face do not lie in a plane.
constexpr double kFlat = 1e-4;

/// Corners of triangles, three to each, in sets that share a normal.
class CornerSets {
 public:
  explicit CornerSets(size_t corners) : parent_(corners) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  uint32_t find(uint32_t corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }
  void join(uint32_t a, uint32_t b) {
    a = find(a), b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<uint32_t> parent_;
};

DVec3 corner_of(const Mesh& mesh, uint32_t corner) {
  return to_double(mesh.positions[mesh.triangles[corner / 3][corner % 3]]);
}

/// A triangle's unit normal, 0 where it has no area, and that area.
struct Face {
  DVec3 normal;
  double area = 0;
};

std::vector<Face> faces_of(const Mesh& mesh) {
  std::vector<Face> out(mesh.triangles.size());
  for (uint32_t t = 0; t < out.size(); ++t) {
    const DVec3 a = corner_of(mesh, 3 * t);
    const DVec3 twice = cross(corner_of(mesh, 3 * t + 1) - a, corner_of(mesh, 3 * t + 2) - a);
    const double area = length(twice) / 2;
    if (area > 0) out[t] = {normalize(twice), area};
  }
  return out;
}

/// One triangle's side of an edge, its ends by position and by corner.
struct HalfEdge {
  uint32_t low, high;  ///< positions, low < high
  uint32_t at_low, at_high;
  bool rises;  ///< from low to high, the triangle's way around
};

std::vector<HalfEdge> half_edges(const Mesh& mesh, std::span<const Face> face,
                                 std::span<const uint32_t> place) {
  std::vector<HalfEdge> out;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (uint32_t k = 0; k < 3 && face[t].area > 0; ++k) {
      const uint32_t a = 3 * t + k, b = 3 * t + (k + 1) % 3;
      const uint32_t from = place[mesh.triangles[t][k]], to = place[mesh.triangles[t][b - 3 * t]];
      if (from == to) continue;
      out.push_back(from < to ? HalfEdge{from, to, a, b, true} : HalfEdge{to, from, b, a, false});
    }
  // Equal edges stay in the order of their triangles: the same sets on every machine.
  std::stable_sort(out.begin(), out.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return a.low != b.low ? a.low < b.low : a.high < b.high;
  });
  return out;
}

/// The angle of a triangle at one of its corners.
double angle_at(const Mesh& mesh, uint32_t corner) {
  const uint32_t first = corner - corner % 3;
  const DVec3 at = corner_of(mesh, corner);
  const DVec3 a = normalize(corner_of(mesh, first + (corner + 1) % 3) - at);
  const DVec3 b = normalize(corner_of(mesh, first + (corner + 2) % 3) - at);
  return std::acos(std::clamp(dot(a, b), -1.0, 1.0));
}

/// `share` tells of two triangles with an edge in common whether they share its normals.
template <class Share>
CornerSets corners_that_share(const Mesh& mesh, std::span<const Face> face, const Share& share) {
  CornerSets sets(3 * mesh.triangles.size());
  const std::vector<HalfEdge> edges = half_edges(mesh, face, position_numbers(mesh.positions));
  for (size_t i = 0; i < edges.size();) {
    size_t end = i + 1;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high)
      ++end;
    const HalfEdge &a = edges[i], &b = edges[end - 1];
    if (end - i == 2 && a.rises != b.rises && share(a.at_low / 3, b.at_low / 3)) {
      sets.join(a.at_low, b.at_low);
      sets.join(a.at_high, b.at_high);
    }
    i = end;
  }
  return sets;
}

/// A unit normal for each corner, the same for all of a set.
std::vector<DVec3> corner_normals(const Mesh& mesh, std::span<const Face> face, CornerSets& sets) {
  std::vector<DVec3> sum(3 * mesh.triangles.size());
  for (uint32_t c = 0; c < sum.size(); ++c)
    if (const auto& [normal, area] = face[c / 3]; area > 0)
      sum[sets.find(c)] += normal * (angle_at(mesh, c) * area);
  std::vector<DVec3> out(sum.size());
  for (uint32_t c = 0; c < sum.size(); ++c) {
    const DVec3 n = sum[sets.find(c)];
    // Triangles that face all ways, as around the tip of a needle, leave none.
    out[c] = length(n) > 1e-9 * face[c / 3].area ? normalize(n) : face[c / 3].normal;
  }
  return out;
}

template <class T>
void repeat(std::vector<T>& values, uint32_t vertex) {
  if (!values.empty()) values.push_back(T(values[vertex]));
}

/// A vertex more, equal to one that there is, but for its normal.
uint32_t repeat_vertex(Mesh& mesh, uint32_t vertex) {
  repeat(mesh.positions, vertex);
  repeat(mesh.uv0, vertex), repeat(mesh.uv1, vertex);
  repeat(mesh.colors, vertex), repeat(mesh.alphas, vertex);
  return uint32_t(mesh.positions.size() - 1);
}

/// Gives each set of corners its normal, and vertices of their own where a vertex has several sets.
void set_normals(Mesh& mesh, std::span<const Face> face, CornerSets& sets) {
  const std::vector<DVec3> normal = corner_normals(mesh, face, sets);
  bool bent = false;
  for (uint32_t c = 0; c < normal.size(); ++c)
    bent |= length(normal[c] - face[c / 3].normal) > kFlat;
  if (!bent) return;

  mesh.normals.resize(mesh.positions.size());
  std::vector<uint32_t> set_of(mesh.positions.size(), kNone);
  std::unordered_map<uint64_t, uint32_t> copies;  // of a vertex, for another set
  for (uint32_t c = 0; c < normal.size(); ++c) {
    uint32_t& vertex = mesh.triangles[c / 3][c % 3];
    const uint32_t set = sets.find(c);
    if (set_of[vertex] == kNone) {
      set_of[vertex] = set, mesh.normals[vertex] = to_float(normal[c]);
    } else if (set_of[vertex] != set) {
      const auto [copy, fresh] = copies.try_emplace(uint64_t(vertex) << 32 | set, 0u);
      if (fresh) {
        copy->second = repeat_vertex(mesh, vertex);
        mesh.normals.push_back(to_float(normal[c]));
      }
      vertex = copy->second;
    }
  }
  // Vertices of no triangle: any normal does.
  for (Vec3& n : mesh.normals)
    if (!(dot(n, n) > 0)) n = {0, 1, 0};
}

}  // namespace

void smooth_normals(Mesh& mesh, float crease_rad) {
  if (!mesh.normals.empty() || !(crease_rad > 0)) return;
  const std::vector<Face> face = faces_of(mesh);
  // A fold of just the crease angle is smooth, also when rounding has made it a little sharper.
  const double least_cosine = std::cos(double(crease_rad)) - 1e-6;
  CornerSets sets = corners_that_share(mesh, face, [&](uint32_t a, uint32_t b) {
    return dot(face[a].normal, face[b].normal) >= least_cosine;
  });
  set_normals(mesh, face, sets);
}

void smooth_normals(Mesh& mesh, std::span<const uint32_t> group) {
  LUXEL_CHECK(group.size() == mesh.triangles.size());
  if (!mesh.normals.empty()) return;
  const std::vector<Face> face = faces_of(mesh);
  CornerSets sets = corners_that_share(mesh, face, [&](uint32_t a, uint32_t b) {
    // The halves of a flat face share their corners whatever its group.
    return ((group[a] == group[b] && group[a] != 0) ||
            length(face[a].normal - face[b].normal) < kFlat);
  });
  set_normals(mesh, face, sets);
}

}  // namespace luxel::scene
