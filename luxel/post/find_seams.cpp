#include <algorithm>
#include <cmath>
#include <tuple>

#include "luxel/base/check.h"
#include "luxel/post/seams.h"
#include "luxel/post/touching.h"
#include "luxel/scene/position_numbers.h"

namespace luxel::post {
namespace {

/// One side of an edge of a mesh: the corner where it starts in its triangle, and the numbers of
/// its two places in space, the smaller one first.
struct HalfEdge {
  uint32_t low = 0, high = 0;
  uint32_t triangle = 0;
  uint32_t low_corner = 0, high_corner = 0;
};

/// Sorted, so that the sides of an edge follow each other.
std::vector<HalfEdge> half_edges(const scene::Mesh& mesh) {
  const std::vector<uint32_t> place = scene::position_numbers(mesh.positions);
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (uint32_t c = 0; c < 3; ++c) {
      const uint32_t d = (c + 1) % 3;
      const uint32_t from = place[mesh.triangles[t][c]], to = place[mesh.triangles[t][d]];
      if (from == to) continue;
      edges.push_back(from < to ? HalfEdge{from, to, t, c, d} : HalfEdge{to, from, t, d, c});
    }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.low, a.high, a.triangle, a.low_corner) <
           std::tie(b.low, b.high, b.triangle, b.low_corner);
  });
  return edges;
}

Barycentric corner(uint32_t c) { return {c == 1 ? 1.0f : 0.0f, c == 2 ? 1.0f : 0.0f}; }

/// Light may pass smoothly over the edge: the shading normals agree at both ends.
bool is_smooth(const scene::Scene& scene, uint32_t instance, const HalfEdge& a, const HalfEdge& b,
               float min_cosine) {
  const auto agree = [&](uint32_t corner_a, uint32_t corner_b) {
    return dot(shading_normal(scene, {instance, a.triangle, corner(corner_a)}),
               shading_normal(scene, {instance, b.triangle, corner(corner_b)})) >= min_cosine;
  };
  return agree(a.low_corner, b.low_corner) && agree(a.high_corner, b.high_corner);
}

/// Returns whether the surface goes on over the edge: then nothing else can join it there.
bool add_seam(const scene::Scene& scene, const atlas::Atlas& atlas, uint32_t instance,
              const HalfEdge& a, const HalfEdge& b, float min_cosine, std::vector<Seam>& seams) {
  const uint32_t number_a = atlas.triangle_number(instance, a.triangle);
  const uint32_t number_b = atlas.triangle_number(instance, b.triangle);
  const auto &in_a = atlas.corners[number_a], &in_b = atlas.corners[number_b];
  const Seam seam{in_a[a.low_corner], in_a[a.high_corner],
                  in_b[b.low_corner], in_b[b.high_corner],
                  number_a,           number_b};
  if (seam.a0 == seam.b0 && seam.a1 == seam.b1) return true;  // one place in the atlas
  if (!is_smooth(scene, instance, a, b, min_cosine)) return false;
  seams.push_back(seam);
  return true;
}

OpenEdge open_edge(uint32_t instance, const HalfEdge& e) {
  const bool forward = (e.low_corner + 1) % 3 == e.high_corner;
  return {instance, e.triangle, forward ? e.low_corner : e.high_corner};
}

}  // namespace

std::vector<Seam> find_seams(const scene::Scene& scene, const atlas::Atlas& atlas,
                             float max_normal_angle_rad) {
  LUXEL_CHECK(atlas.first_triangle.size() == scene.instances.size() + 1);
  const float min_cosine = std::cos(max_normal_angle_rad);
  std::vector<std::vector<HalfEdge>> edges_of(scene.meshes.size());
  std::vector<Seam> seams;
  std::vector<OpenEdge> open;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const uint32_t mesh = scene.instances[i].mesh;
    std::vector<HalfEdge>& edges = edges_of[mesh];
    if (edges.empty()) edges = half_edges(scene.meshes[mesh]);
    for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
      while (end < edges.size() && edges[end].low == edges[begin].low &&
             edges[end].high == edges[begin].high)
        ++end;
      // Two sides as a rule. Where more triangles meet, each goes with the next: all that agree
      // hang together, without a square number of pairs.
      bool joined = false;
      for (size_t a = begin; a < end; ++a) {
        const bool before = joined;
        joined =
            a + 1 < end && add_seam(scene, atlas, i, edges[a], edges[a + 1], min_cosine, seams);
        if (!before && !joined) open.push_back(open_edge(i, edges[a]));
      }
    }
  }
  const std::vector<Seam> touching = find_touching(scene, atlas, open, min_cosine);
  seams.insert(seams.end(), touching.begin(), touching.end());
  return seams;
}

}  // namespace luxel::post
