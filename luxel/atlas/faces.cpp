#include "luxel/atlas/faces.h"

#include <algorithm>
#include <tuple>

#include "luxel/atlas/atlas.h"
#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/scene/position_numbers.h"

namespace luxel::atlas {
namespace {

/// An edge of a face, named by the places of its ends in ascending order.
struct HalfEdge {
  uint32_t low, high, face;
  uint8_t side;  ///< runs from corner `side` to the next
  bool upwards;  ///< runs from low to high
  friend bool operator<(const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.low, a.high, a.face, a.side) < std::tie(b.low, b.high, b.face, b.side);
  }
};

/// Joins the faces around one edge in pairs, the flattest pair first. More than two faces share an
/// edge where walls meet a floor, or where a mesh holds both sides of a sheet; only edges that run
/// against each other belong to one oriented surface.
void join_around_edge(const HalfEdge* edges, size_t count, Faces& faces) {
  constexpr size_t kMost = 32;  // beyond it lies a broken fan, whose faces may stay apart
  struct Pair {
    double angle;
    size_t a, b;
  };
  std::vector<Pair> pairs;
  for (size_t a = 0; a < std::min(count, kMost); ++a)
    for (size_t b = a + 1; b < std::min(count, kMost); ++b)
      if (edges[a].upwards != edges[b].upwards && edges[a].face != edges[b].face)
        pairs.push_back(
            {angle_between(faces.normal[edges[a].face], faces.normal[edges[b].face]), a, b});
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& p, const Pair& q) { return p.angle + 1e-5 < q.angle; });
  for (const Pair& p : pairs) {
    uint32_t& from_a = faces.across[edges[p.a].face][edges[p.a].side];
    uint32_t& from_b = faces.across[edges[p.b].face][edges[p.b].side];
    if (from_a != kNone || from_b != kNone) continue;
    from_a = edges[p.b].face;
    from_b = edges[p.a].face;
  }
}

void join_faces(const scene::Mesh& mesh, const std::vector<uint32_t>& place, uint32_t first,
                Faces& faces) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (uint8_t k = 0; k < 3; ++k) {
      const uint32_t a = place[mesh.triangles[t][k]], b = place[mesh.triangles[t][(k + 1) % 3]];
      if (a != b) edges.push_back({std::min(a, b), std::max(a, b), first + t, k, a < b});
    }
  std::sort(edges.begin(), edges.end());
  for (size_t i = 0; i < edges.size();) {
    size_t j = i + 1;
    while (j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high) ++j;
    if (j - i > 1) join_around_edge(&edges[i], j - i, faces);
    i = j;
  }
}

}  // namespace

Faces make_faces(const scene::Scene& scene) {
  const std::vector<uint32_t> first = scene::first_triangles(scene);
  Faces faces;
  faces.corners.resize(first.back());
  faces.normal.resize(first.back());
  faces.area.resize(first.back());
  faces.across.assign(first.back(), {kNone, kNone, kNone});
  // Vertices at one position count as one: exporters split them along seams.
  std::vector<std::vector<uint32_t>> places(scene.meshes.size());
  for (size_t m = 0; m < scene.meshes.size(); ++m)
    places[m] = scene::position_numbers(scene.meshes[m].positions);

  // Corners, normal and area in the world, then the neighbours across edges.
  parallel_for(scene.instances.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const scene::Instance& instance = scene.instances[i];
      const double side = determinant(instance.world_from_object) < 0 ? -1 : 1;
      const double density = double(scene::layout_density(instance));
      for (uint32_t t = 0; t < scene.meshes[instance.mesh].triangles.size(); ++t) {
        const scene::Triangle3 w = scene::world_triangle(scene, uint32_t(i), t);
        const std::array<DVec3, 3> c{to_double(w.a) * density, to_double(w.b) * density,
                                     to_double(w.c) * density};
        const DVec3 area2 = cross(c[1] - c[0], c[2] - c[0]) * side;
        faces.corners[first[i] + t] = c;
        faces.normal[first[i] + t] = normalize(area2);
        faces.area[first[i] + t] = 0.5 * length(area2);
      }
      join_faces(scene.meshes[instance.mesh], places[instance.mesh], first[i], faces);
    }
  });
  return faces;
}

void part_groups(Faces& faces, std::span<const uint32_t> group) {
  LUXEL_CHECK(group.size() == faces.size());
  for (size_t f = 0; f < faces.size(); ++f)
    for (uint32_t& g : faces.across[f])
      if (g != kNone && group[g] != group[f]) g = kNone;
}

}  // namespace luxel::atlas
