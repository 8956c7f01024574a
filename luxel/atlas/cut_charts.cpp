#include "luxel/atlas/cut_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "luxel/base/check.h"
#include "luxel/scene/cut_mesh.h"
#include "luxel/scene/join_pieces.h"
#include "luxel/scene/t_junctions.h"

namespace luxel::atlas {
namespace {

using Pairs = std::vector<PartedPoints>;

/// A vertex this close to a plane, in distances of the pairs, lies on it.
constexpr double kOnPlane = 0.02;
/// Pieces that fewer pairs connect are apart: one or two lie where barriers meet.
constexpr size_t kFewestJoined = kFewestParted;
/// Triangles farther than this from all pairs, in distances of a typical one, stay whole: light
/// comes around the end of a barrier within three texels.
constexpr double kNear = 3;
/// Triangles whose edges are shorter than this, in distances of a typical pair, stay whole: the
/// half of a texel on the other side of a barrier lies beneath it, or is the texel that it stands
/// on.
constexpr double kFine = 0.5;
/// A plane parts so many pairs, or more, per triangle that it cuts. A wall does; petals and blades
/// of grass that stand on fine triangles do not, each of which parts a texel or two.
constexpr size_t kPartedPerTriangle = 1;
/// More planes than these are not looked at in one piece.
constexpr size_t kMostCandidates = 256, kMostScored = 32;

struct CutCandidate {
  Plane plane;
  size_t count = 0;
};

bool same_plane(const Plane& p, const Plane& q, DVec3 at, double reach) {
  return std::abs(dot(p.normal, q.normal)) > 0.9995 && std::abs(p.height(at)) < 0.25 * reach;
}

bool parts(const Plane& plane, const PartedPoints& pair) {
  const double a = plane.height(to_double(pair.a)), b = plane.height(to_double(pair.b));
  return (a < 0) != (b < 0);
}

/// The planes between the pairs, those of most pairs first.
std::vector<CutCandidate> candidates_of(const Pairs& pairs) {
  std::vector<CutCandidate> found;
  for (const PartedPoints& pair : pairs) {
    const DVec3 a = to_double(pair.a), b = to_double(pair.b);
    if (!parts(pair.between, pair)) continue;
    const double reach = length(b - a);
    const auto same = std::find_if(found.begin(), found.end(), [&](const CutCandidate& c) {
      const double s = pair.between.height(a) / (pair.between.height(a) - pair.between.height(b));
      return same_plane(c.plane, pair.between, a + (b - a) * s, reach);
    });
    if (same != found.end())
      ++same->count;
    else if (found.size() < kMostCandidates)
      found.push_back({pair.between, 1});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const CutCandidate& p, const CutCandidate& q) { return p.count > q.count; });
  if (found.size() > kMostScored) found.resize(kMostScored);
  return found;
}

/// The plane that parts most pairs, and how many.
CutCandidate best_plane(const Pairs& pairs) {
  CutCandidate best;
  for (const CutCandidate& c : candidates_of(pairs)) {
    const auto parted = size_t(std::count_if(
        pairs.begin(), pairs.end(), [&](const PartedPoints& p) { return parts(c.plane, p); }));
    if (parted > best.count) best = {c.plane, parted};
  }
  return best;
}

/// Where the pairs of a piece lie.
class PairPlaces {
 public:
  explicit PairPlaces(const Pairs& pairs) {
    std::vector<double> distances;
    for (const PartedPoints& p : pairs) distances.push_back(double(length(p.b - p.a)));
    const auto middle = distances.begin() + long(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    distance_ = *middle;
    // One of the pairs in a cell of a grid that is finer than they are far apart speaks for all.
    std::set<std::array<long, 3>> seen;
    for (const PartedPoints& p : pairs) {
      const DVec3 at = (to_double(p.a) + to_double(p.b)) * 0.5, cell = at * (1 / distance_);
      if (seen.insert({std::lround(cell.x), std::lround(cell.y), std::lround(cell.z)}).second)
        places_.push_back(at);
    }
  }

  double distance() const { return distance_; }  ///< of a typical pair's points [m]
  /// True where some lie near a line from a to b.
  bool is_near(DVec3 a, DVec3 b) const {
    const DVec3 along = b - a;
    const double length2 = dot(along, along), reach = kNear * distance_;
    return std::ranges::any_of(places_, [&](DVec3 p) {
      const double s = length2 > 0 ? std::clamp(dot(p - a, along) / length2, 0.0, 1.0) : 0;
      const DVec3 d = p - (a + along * s);
      return dot(d, d) <= reach * reach;
    });
  }

 private:
  double distance_ = 0;
  std::vector<DVec3> places_;
};

/// A node of the partition of one chart. Leaves are pieces.
struct Node {
  uint32_t piece = 0;                     ///< of a leaf: the label of its triangles
  uint32_t below = kNone, above = kNone;  ///< nodes
  Plane plane{};
};

/// A plane, in object space, and the triangles that it is to cut.
struct Cut {
  Plane plane;
  double tolerance = 0;  ///< of cut_mesh() [m]
  std::vector<uint8_t> chosen;
};

/// Works on one instance, whose mesh is its own.
class Cutter {
 public:
  Cutter(scene::Mesh& mesh, const Mat34& world_from_object, std::vector<uint32_t> chart)
      : mesh_(mesh), world_from_object_(world_from_object), label_(std::move(chart)) {
    for (const uint32_t c : label_) next_ = std::max(next_, c + 1);
    part_of_.resize(label_.size());
    std::iota(part_of_.begin(), part_of_.end(), 0u);
  }

  /// Cuts one chart. Its triangles are labelled by piece; returns the group of each piece, as
  /// (label, colour).
  std::vector<std::pair<uint32_t, uint32_t>> cut(uint32_t chart, const Pairs& pairs) {
    nodes_ = {Node{chart}};
    divide(0, pairs);
    return colour_pieces(pairs);
  }

  const std::vector<uint32_t>& labels() const { return label_; }
  /// Per triangle, the number of the one it was a part of.
  const std::vector<uint32_t>& part_of() const { return part_of_; }
  /// The chart that a label's triangles are of.
  uint32_t chart_of(uint32_t label) const {
    const auto found = std::ranges::find(pieces_, label, &std::pair<uint32_t, uint32_t>::first);
    return found == pieces_.end() ? label : found->second;
  }
  uint32_t cuts() const { return cuts_; }

 private:
  void divide(uint32_t node, const Pairs& pairs) {
    if (pairs.size() < kFewestParted) return;
    const CutCandidate best = best_plane(pairs);
    if (best.count < kFewestParted) return;
    const uint32_t piece = nodes_[node].piece;
    const Cut cut = cut_of(piece, best.plane, PairPlaces(pairs));
    if (best.count < kPartedPerTriangle * size_t(std::ranges::count(cut.chosen, 1))) return;
    const uint32_t other = apply(piece, cut);
    const auto below = uint32_t(nodes_.size()), above = below + 1;
    nodes_[node].plane = best.plane, nodes_[node].below = below, nodes_[node].above = above;
    nodes_.push_back(Node{piece});
    nodes_.push_back(Node{other});
    Pairs lower, upper;
    for (const PartedPoints& p : pairs)
      if (!parts(best.plane, p))
        (best.plane.height(to_double(p.a)) < 0 ? lower : upper).push_back(p);
    divide(below, lower);
    divide(above, upper);
  }

  /// The triangles of a piece that a plane of the world is to cut. Those that are not near any pair
  /// are not cut, nor fine ones: they lie where most of them does.
  Cut cut_of(uint32_t piece, const Plane& world, const PairPlaces& places) const {
    Cut cut{scene::plane_in_object(world, world_from_object_), kOnPlane * places.distance(),
            std::vector<uint8_t>(label_.size())};
    for (size_t t = 0; t < label_.size(); ++t)
      cut.chosen[t] = label_[t] == piece && is_cut_near(t, cut, places);
    return cut;
  }

  /// All above the plane gets a new label, which is returned.
  uint32_t apply(uint32_t piece, const Cut& cut) {
    for (const uint32_t t : scene::cut_mesh(mesh_, cut.chosen, cut.plane, cut.tolerance))
      label_.push_back(label_[t]), part_of_.push_back(part_of_[t]);
    const uint32_t other = next_++;
    pieces_.push_back({other, chart_of(piece)});
    for (size_t t = 0; t < label_.size(); ++t)
      if (label_[t] == piece && lies_above(cut.plane, t)) label_[t] = other;
    ++cuts_;
    return other;
  }

  bool is_cut_near(size_t triangle, const Cut& cut, const PairPlaces& places) const {
    std::vector<DVec3> on_plane;  // world
    double longest = 0;           // edge, in m
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 p = mesh_.positions[mesh_.triangles[triangle][k]];
      const Vec3 q = mesh_.positions[mesh_.triangles[triangle][(k + 1) % 3]];
      const double a = cut.plane.height(to_double(p)), b = cut.plane.height(to_double(q));
      const DVec3 from = to_double(transform_point(world_from_object_, p));
      const DVec3 to = to_double(transform_point(world_from_object_, q));
      longest = std::max(longest, length(to - from));
      if (std::abs(a) <= cut.tolerance) on_plane.push_back(from);
      if (std::min(a, b) >= -cut.tolerance || std::max(a, b) <= cut.tolerance) continue;
      on_plane.push_back(from + (to - from) * (a / (a - b)));
    }
    return on_plane.size() == 2 && longest >= kFine * places.distance() &&
           places.is_near(on_plane[0], on_plane[1]);
  }

  bool lies_above(const Plane& plane, size_t triangle) const {
    double farthest = 0;
    for (const uint32_t v : mesh_.triangles[triangle]) {
      const double h = plane.height(to_double(mesh_.positions[v]));
      if (std::abs(h) > std::abs(farthest)) farthest = h;
    }
    return farthest > 0;
  }

  uint32_t piece_at(Vec3 p) const {
    uint32_t node = 0;
    while (nodes_[node].below != kNone)
      node = nodes_[node].plane.height(to_double(p)) < 0 ? nodes_[node].below : nodes_[node].above;
    return nodes_[node].piece;
  }

  /// Each piece takes the first colour that no piece has with which kFewestJoined pairs connect it:
  /// fewer lie at the ends of a barrier, where light comes around it.
  std::vector<std::pair<uint32_t, uint32_t>> colour_pieces(const Pairs& pairs) const {
    std::vector<std::pair<uint32_t, uint32_t>> edges;
    for (const PartedPoints& p : pairs) {
      const uint32_t a = piece_at(p.a), b = piece_at(p.b);
      if (a != b) edges.push_back({a, b}), edges.push_back({b, a});
    }
    std::sort(edges.begin(), edges.end());
    size_t kept = 0;
    for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
      while (end < edges.size() && edges[end] == edges[begin]) ++end;
      if (end - begin >= kFewestJoined) edges[kept++] = edges[begin];
    }
    edges.resize(kept);
    std::vector<std::pair<uint32_t, uint32_t>> coloured;
    for (const Node& node : nodes_) {
      if (node.below != kNone) continue;
      std::vector<uint32_t> taken;
      for (const auto& [piece, colour] : coloured)
        if (std::binary_search(edges.begin(), edges.end(), std::pair(node.piece, piece)))
          taken.push_back(colour);
      uint32_t colour = 0;
      while (std::find(taken.begin(), taken.end(), colour) != taken.end()) ++colour;
      coloured.push_back({node.piece, colour});
    }
    return coloured;
  }

  scene::Mesh& mesh_;
  Mat34 world_from_object_;
  std::vector<uint32_t> label_;  ///< per triangle: its chart, or its piece of one
  std::vector<uint32_t> part_of_;
  std::vector<Node> nodes_;                            ///< of the chart that is being cut
  std::vector<std::pair<uint32_t, uint32_t>> pieces_;  ///< new labels, and of which charts
  uint32_t next_ = 0;
  uint32_t cuts_ = 0;
};

/// Instance by instance, so that the mesh of a heavy scene is copied only where it is cut.
struct Cutting {
  CutScene& out;
  std::vector<uint32_t> group_of_chart;      ///< before: what is not cut stays in it
  std::vector<std::vector<uint32_t>> group;  ///< per instance and triangle; empty: not cut
  uint32_t groups = 1;
  std::vector<scene::Uncut> before;  ///< per instance
};

void cut_instance(Cutting& cutting, uint32_t instance, std::vector<uint32_t> chart,
                  const Pairs& pairs) {
  scene::Scene& scene = cutting.out.scene;
  scene::Mesh mesh = scene.meshes[scene.instances[instance].mesh];
  Cutter cutter(mesh, scene.instances[instance].world_from_object, std::move(chart));
  std::vector<std::pair<uint32_t, uint32_t>> group_of_piece;
  for (size_t begin = 0, end = 0; begin < pairs.size(); begin = end) {
    while (end < pairs.size() && pairs[end].chart == pairs[begin].chart) ++end;
    const auto coloured =
        cutter.cut(pairs[begin].chart, {pairs.begin() + long(begin), pairs.begin() + long(end)});
    if (coloured.size() < 2) continue;
    uint32_t colours = 0;
    for (const auto& [piece, colour] : coloured) {
      group_of_piece.push_back({piece, cutting.groups + colour});
      colours = std::max(colours, colour + 1);
    }
    cutting.groups += colours;
  }
  if (cutter.cuts() == 0) return;
  cutting.out.cuts += cutter.cuts();
  std::sort(group_of_piece.begin(), group_of_piece.end());
  scene::CutTriangles cut{cutter.part_of(), {}};
  for (const uint32_t label : cutter.labels()) {
    const auto found =
        std::lower_bound(group_of_piece.begin(), group_of_piece.end(), std::pair(label, 0u));
    const bool is_piece = found != group_of_piece.end() && found->first == label;
    cut.group.push_back(is_piece ? found->second : cutting.group_of_chart[cutter.chart_of(label)]);
  }
  scene::join_pieces(mesh, cut, cutting.before[instance].vertices);
  cutting.group[instance] = std::move(cut.group);
  scene::Mesh& own = scene::own_mesh(scene, instance);
  for (const uint32_t t : cut.part_of) cutting.before[instance].whole.push_back(own.triangles[t]);
  own = std::move(mesh);
}

/// Neighbours in other meshes, and of edges that did not match before, get the new vertices, too.
void divide_neighbours(Cutting& cutting, const Atlas& atlas) {
  const auto part_of = scene::close_t_junctions(cutting.out.scene, std::move(cutting.before));
  for (uint32_t i = 0; i < part_of.size(); ++i) {
    if (part_of[i].empty()) continue;
    std::vector<uint32_t>& group = cutting.group[i];
    if (group.empty())
      for (uint32_t t = atlas.first_triangle[i]; t < atlas.first_triangle[i + 1]; ++t)
        group.push_back(cutting.group_of_chart[atlas.chart[t]]);
    for (const uint32_t t : part_of[i]) group.push_back(uint32_t(group[t]));
  }
}

}  // namespace

CutScene cut_charts(scene::Scene scene, const Atlas& atlas, std::span<const PartedPoints> parted,
                    std::span<const uint32_t> group) {
  CutScene out;
  out.scene = std::move(scene);
  LUXEL_CHECK(atlas.first_triangle.size() == out.scene.instances.size() + 1);
  std::vector<uint32_t> instance_of_chart(atlas.chart_count);
  LUXEL_CHECK(group.empty() || group.size() == atlas.chart.size());
  Cutting cutting{out, std::vector<uint32_t>(atlas.chart_count), {}, 1, {}};
  cutting.group.resize(out.scene.instances.size());
  for (size_t t = 0; t < group.size(); ++t) {
    cutting.group_of_chart[atlas.chart[t]] = group[t];
    cutting.groups = std::max(cutting.groups, group[t] + 1);
  }
  for (uint32_t i = 0; i < out.scene.instances.size(); ++i)
    for (uint32_t t = atlas.first_triangle[i]; t < atlas.first_triangle[i + 1]; ++t)
      instance_of_chart[atlas.chart[t]] = i;
  for (const scene::Instance& instance : out.scene.instances)
    cutting.before.push_back({uint32_t(out.scene.meshes[instance.mesh].positions.size()), {}});
  // Pairs by instance and chart.
  Pairs pairs(parted.begin(), parted.end());
  std::stable_sort(pairs.begin(), pairs.end(), [&](const PartedPoints& p, const PartedPoints& q) {
    return std::pair(instance_of_chart[p.chart], p.chart) <
           std::pair(instance_of_chart[q.chart], q.chart);
  });
  // Cut the charts of each instance that has any.
  for (size_t begin = 0, end = 0; begin < pairs.size(); begin = end) {
    const uint32_t i = instance_of_chart[pairs[begin].chart];
    while (end < pairs.size() && instance_of_chart[pairs[end].chart] == i) ++end;
    cut_instance(cutting, i,
                 {atlas.chart.begin() + atlas.first_triangle[i],
                  atlas.chart.begin() + atlas.first_triangle[i + 1]},
                 {pairs.begin() + long(begin), pairs.begin() + long(end)});
  }
  if (out.cuts > 0) divide_neighbours(cutting, atlas);
  // One list of groups over all instances; what was not cut stays in its own.
  for (uint32_t i = 0; i < out.scene.instances.size(); ++i) {
    const std::vector<uint32_t>& cut = cutting.group[i];
    out.group.insert(out.group.end(), cut.begin(), cut.end());
    if (!cut.empty()) continue;
    for (uint32_t t = atlas.first_triangle[i]; t < atlas.first_triangle[i + 1]; ++t)
      out.group.push_back(cutting.group_of_chart[atlas.chart[t]]);
  }
  return out;
}

}  // namespace luxel::atlas
