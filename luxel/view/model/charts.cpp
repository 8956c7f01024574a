#include "luxel/view/model/charts.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "luxel/base/disjoint_sets.h"

namespace luxel::view {
namespace {

/// Vertices by what they have in common: the number of the first vertex of each kind.
template <class Key>
std::vector<uint32_t> first_alike(uint32_t vertices, const Key& key_of) {
  std::vector<uint32_t> order(vertices), out(vertices);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return key_of(a) < key_of(b); });
  for (size_t i = 0; i < order.size(); ++i) {
    const bool is_alike = i > 0 && key_of(order[i - 1]) == key_of(order[i]);
    out[order[i]] = is_alike ? out[order[i - 1]] : order[i];
  }
  return out;
}

/// An edge of a triangle, the one across from a corner.
struct ChartEdge {
  std::array<uint32_t, 2> places;   ///< its ends, by what places they have
  std::array<uint32_t, 2> corners;  ///< and by their places in the lightmap, too
  uint32_t triangle = 0;
  uint8_t across = 0;
};

std::array<uint32_t, 2> sorted_pair(uint32_t a, uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

/// All edges, those with the same ends behind one another.
std::vector<ChartEdge> edges_of(const scene::Mesh& mesh, std::span<const Vec2> light_uv) {
  const auto count = uint32_t(mesh.positions.size());
  const auto place = [&](uint32_t i) {
    const Vec3 p = mesh.positions[i];
    return std::tuple(p.x, p.y, p.z);
  };
  const auto place_and_uv = [&](uint32_t i) {
    return std::tuple_cat(place(i), std::tuple(light_uv[i].x, light_uv[i].y));
  };
  const std::vector<uint32_t> places = first_alike(count, place);
  const std::vector<uint32_t> corners = first_alike(count, place_and_uv);
  std::vector<ChartEdge> out;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (uint8_t k = 0; k < 3; ++k) {
      const uint32_t a = mesh.triangles[t][(k + 1u) % 3], b = mesh.triangles[t][(k + 2u) % 3];
      out.push_back({sorted_pair(places[a], places[b]), sorted_pair(corners[a], corners[b]), t, k});
    }
  std::stable_sort(out.begin(), out.end(), [](const ChartEdge& a, const ChartEdge& b) {
    return std::tie(a.places, a.corners) < std::tie(b.places, b.corners);
  });
  return out;
}

using EdgeIterator = std::vector<ChartEdge>::const_iterator;

/// Where the run of edges ends that are alike in one member.
template <class Member>
EdgeIterator end_of_run(EdgeIterator from, EdgeIterator last, Member member) {
  return std::find_if(from, last, [&](const ChartEdge& e) { return e.*member != (*from).*member; });
}

}  // namespace

MeshCharts charts_of(const scene::Mesh& mesh, std::span<const Vec2> light_uv) {
  MeshCharts out;
  if (light_uv.empty()) return out;
  const std::vector<ChartEdge> edges = edges_of(mesh, light_uv);
  std::vector<uint32_t> parent(mesh.triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  out.seams.assign(mesh.triangles.size(), 0);
  for (auto here = edges.cbegin(); here != edges.cend();) {
    const auto end = end_of_run(here, edges.cend(), &ChartEdge::places);
    const bool has_neighbour = end - here > 1;
    while (here != end) {
      const auto next = end_of_run(here, end, &ChartEdge::corners);
      for (auto other = here + 1; other != next; ++other)
        parent[root_of(parent, other->triangle)] = root_of(parent, here->triangle);
      if (next - here == 1 && has_neighbour)
        out.seams[here->triangle] |= uint8_t(1u << here->across);
      here = next;
    }
  }
  std::map<uint32_t, uint32_t> numbers;
  for (uint32_t t = 0; t < parent.size(); ++t)
    out.chart_of.push_back(
        numbers.try_emplace(root_of(parent, t), uint32_t(numbers.size())).first->second);
  out.charts = uint32_t(numbers.size());
  return out;
}

}  // namespace luxel::view
