#include "luxel/scene/join_pieces.h"

#include <algorithm>
#include <optional>
#include <unordered_map>

#include "luxel/base/check.h"
#include "luxel/scene/position_numbers.h"

namespace luxel::scene {
namespace {

/// The distance by which rounding moves a vertex, relative to the largest coordinate: two units in
/// the last place, twice, for the ends of an edge are rounded, too.
constexpr double kRoundingOfCuts = 1.0 / (1 << 22);

/// Pieces of one triangle and group around a vertex: what they cover, as a sum of normals as long
/// as twice the areas. It stays the same where no piece turns over and the outline stays.
struct Cover {
  uint32_t part_of = 0, group = 0;
  DVec3 before{}, after{};
  bool is_left = false;
};

class Joiner {
 public:
  Joiner(Mesh& mesh, CutTriangles& cut, uint32_t first_vertex)
      : mesh_(mesh),
        cut_(cut),
        place_(position_numbers(mesh.positions)),
        is_gone_(mesh.triangles.size()) {
    double largest = 0;
    for (const Vec3& p : mesh.positions)
      largest =
          std::max({largest, std::abs(double(p.x)), std::abs(double(p.y)), std::abs(double(p.z))});
    tolerance_ = kRoundingOfCuts * largest;
    for (uint32_t v = first_vertex; v < place_.size(); ++v) around_[place_[v]];
    for (uint32_t v = 0; v < first_vertex; ++v) around_.erase(place_[v]);
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
      for (const uint32_t v : mesh.triangles[t])
        if (const auto found = around_.find(place_[v]); found != around_.end())
          found->second.push_back(t);
    for (const auto& [place, ring] : around_) waiting_.push_back(place);
    std::ranges::sort(waiting_);
  }

  const std::vector<uint8_t>& run() {
    while (!waiting_.empty()) {
      std::vector<uint32_t> next;
      for (const uint32_t place : waiting_) remove(place, next);
      std::ranges::sort(next);
      next.erase(std::unique(next.begin(), next.end()), next.end());
      waiting_ = std::move(next);
    }
    return is_gone_;
  }

 private:
  using Ring = std::vector<uint32_t>;

  DVec3 at(uint32_t vertex) const { return to_double(mesh_.positions[vertex]); }

  /// The vertex of a triangle at a place.
  std::optional<uint32_t> vertex_at(uint32_t triangle, uint32_t place) const {
    for (const uint32_t v : mesh_.triangles[triangle])
      if (place_[v] == place) return v;
    return {};
  }

  Cover& cover_of(uint32_t triangle) {
    for (Cover& c : covers_)
      if (c.part_of == cut_.part_of[triangle] && c.group == cut_.group[triangle]) return c;
    covers_.push_back({cut_.part_of[triangle], cut_.group[triangle], {}, {}, false});
    return covers_.back();
  }

  DVec3 normal_area2(const std::array<uint32_t, 3>& c) const {
    return cross(at(c[1]) - at(c[0]), at(c[2]) - at(c[0]));
  }

  /// The vertex at the place `to` for a triangle around `from`: that of its neighbour in the same
  /// triangle, which has the same attributes there.
  std::optional<uint32_t> successor(const Ring& ring, uint32_t triangle, uint32_t to) const {
    for (const uint32_t t : ring)
      if (cut_.part_of[t] == cut_.part_of[triangle])
        if (const auto v = vertex_at(t, to)) return v;
    return {};
  }

  std::optional<std::array<uint32_t, 3>> moved(const Ring& ring, uint32_t triangle, uint32_t from,
                                               uint32_t to) const {
    std::array<uint32_t, 3> out = mesh_.triangles[triangle];
    for (uint32_t& v : out) {
      if (place_[v] != from) continue;
      const auto next = successor(ring, triangle, to);
      if (!next) return {};
      v = *next;
    }
    return out;
  }

  /// The least height over length of the triangles that are left when the vertices at `from` move
  /// to the place `to`; nothing where they would cover something else.
  std::optional<double> shape_after(const Ring& ring, uint32_t from, uint32_t to, double reach) {
    for (Cover& c : covers_) c.after = {}, c.is_left = false;
    double worst = 1;
    for (const uint32_t t : ring) {
      if (vertex_at(t, to)) continue;
      const auto corners = moved(ring, t, from, to);
      if (!corners) return {};
      const DVec3 n = normal_area2(*corners);
      double longest = 0;
      for (size_t k = 0; k < 3; ++k)
        longest = std::max(longest, length(at((*corners)[(k + 1) % 3]) - at((*corners)[k])));
      Cover& cover = cover_of(t);
      if (dot(n, cover.before) <= 0 || length(n) <= tolerance_ * longest) return {};
      cover.after += n, cover.is_left = true;
      worst = std::min(worst, length(n) / (longest * longest));
    }
    for (const Cover& c : covers_)
      if (!c.is_left || length(c.after - c.before) > 2 * tolerance_ * reach) return {};
    return worst;
  }

  /// Moves the vertices at a place into those of a neighbour, if any will do.
  void remove(uint32_t place, std::vector<uint32_t>& look_again) {
    const auto found = around_.find(place);
    if (found == around_.end()) return;
    Ring& ring = found->second;
    std::erase_if(ring, [&](uint32_t t) { return is_gone_[t] || !vertex_at(t, place); });
    covers_.clear();
    double reach = 0;
    std::vector<uint32_t> neighbours;
    for (const uint32_t t : ring) {
      cover_of(t).before += normal_area2(mesh_.triangles[t]);
      for (const uint32_t v : mesh_.triangles[t]) {
        if (place_[v] == place) continue;
        neighbours.push_back(place_[v]);
        reach = std::max(reach, length(at(v) - at(*vertex_at(t, place))));
      }
    }
    std::ranges::sort(neighbours);
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
    std::optional<uint32_t> best;
    double best_shape = 0;
    for (const uint32_t to : neighbours)
      if (const auto shape = shape_after(ring, place, to, reach); shape && *shape > best_shape)
        best = to, best_shape = *shape;
    if (!best) return;
    move(Ring(ring), place, *best);
    for (const uint32_t n : neighbours)
      if (around_.contains(n)) look_again.push_back(n);
  }

  void move(const Ring& ring, uint32_t from, uint32_t to) {
    const auto heir = around_.find(to);
    std::vector<std::pair<uint32_t, std::array<uint32_t, 3>>> changed;
    for (const uint32_t t : ring)
      if (!vertex_at(t, to)) changed.push_back({t, *moved(ring, t, from, to)});
    for (const uint32_t t : ring)
      if (vertex_at(t, to)) is_gone_[t] = 1;
    for (const auto& [t, corners] : changed) {
      mesh_.triangles[t] = corners;
      if (heir != around_.end()) heir->second.push_back(t);
    }
    around_.erase(from);
  }

  Mesh& mesh_;
  const CutTriangles& cut_;
  std::vector<uint32_t> place_;                ///< per vertex, the number of its position
  std::vector<uint8_t> is_gone_;               ///< per triangle
  double tolerance_ = 0;                       ///< object space
  std::unordered_map<uint32_t, Ring> around_;  ///< places of new vertices: the triangles there
  std::vector<uint32_t> waiting_;              ///< places to look at
  std::vector<Cover> covers_;                  ///< around the place that is looked at
};

/// The triangles that are left: the first piece of each at its number, and then the others.
std::vector<uint32_t> order_of_pieces(const CutTriangles& cut,
                                      const std::vector<uint8_t>& is_gone) {
  std::vector<uint32_t> first, rest;
  for (uint32_t t = 0; t < is_gone.size(); ++t) {
    const uint32_t whole = cut.part_of[t];
    if (whole == t) first.push_back(kNone);
    if (is_gone[t]) continue;
    if (first[whole] == kNone)
      first[whole] = t;
    else
      rest.push_back(t);
  }
  LUXEL_CHECK(std::ranges::find(first, kNone) == first.end());
  first.insert(first.end(), rest.begin(), rest.end());
  return first;
}

template <class T>
void pick(std::vector<T>& values, const std::vector<uint32_t>& numbers) {
  if (values.empty()) return;
  std::vector<T> out;
  for (const uint32_t n : numbers) out.push_back(values[n]);
  values = std::move(out);
}

void drop_triangles(Mesh& mesh, CutTriangles& cut, const std::vector<uint32_t>& order) {
  std::vector<uint32_t> number(mesh.triangles.size(), kNone);
  for (uint32_t t = 0; t < order.size(); ++t) number[order[t]] = t;
  for (uint32_t& other : mesh.other_side)
    if (other != kNone) other = number[other];
  pick(mesh.triangles, order), pick(mesh.triangle_material, order), pick(mesh.other_side, order);
  pick(cut.part_of, order), pick(cut.group, order);
}

void drop_vertices(Mesh& mesh, uint32_t first_vertex) {
  std::vector<uint8_t> is_used(mesh.positions.size());
  for (const auto& corners : mesh.triangles)
    for (const uint32_t v : corners) is_used[v] = 1;
  std::vector<uint32_t> kept, number(mesh.positions.size());
  for (uint32_t v = 0; v < is_used.size(); ++v) {
    number[v] = uint32_t(kept.size());
    if (v < first_vertex || is_used[v]) kept.push_back(v);
  }
  for (auto& corners : mesh.triangles)
    for (uint32_t& v : corners) v = number[v];
  pick(mesh.positions, kept), pick(mesh.normals, kept), pick(mesh.uv0, kept);
  pick(mesh.uv1, kept), pick(mesh.colors, kept), pick(mesh.alphas, kept);
}

}  // namespace

void join_pieces(Mesh& mesh, CutTriangles& cut, uint32_t first_vertex) {
  LUXEL_CHECK(cut.part_of.size() == mesh.triangles.size());
  LUXEL_CHECK(cut.group.size() == mesh.triangles.size());
  const std::vector<uint8_t> is_gone = Joiner(mesh, cut, first_vertex).run();
  drop_triangles(mesh, cut, order_of_pieces(cut, is_gone));
  drop_vertices(mesh, first_vertex);
}

}  // namespace luxel::scene
