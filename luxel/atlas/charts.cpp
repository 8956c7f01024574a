#include "luxel/atlas/charts.h"

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "luxel/atlas/atlas.h"
#include "luxel/atlas/outline.h"

namespace luxel::atlas {
namespace {

constexpr double kFlatAngle = 0.01;    ///< faces this close to a patch's first face are coplanar
constexpr double kCreaseAngle = 0.75;  ///< light changes at a sharper edge: no chart crosses it

constexpr size_t kManyNormals = 64;     ///< of fewer, none is left out
constexpr double kSurelyInFront = 0.2;  ///< cosine of less than a right angle

/// A size or cost in steps of one percent, so that symmetric candidates compare equal whatever the
/// unit of length did to their last digits. What is as good as nothing is one step, too, and so is
/// what is no number.
double rounded(double share) { return std::floor(std::log2(std::max(1e-14, share)) * 64 + 0.37); }

/// Coplanar neighbours share a number. Large faces come first: their normals are the best known.
std::vector<uint32_t> flat_patches(const Faces& faces, uint32_t& count) {
  // Faces by their share of the area, in steps, so that equal ones keep the order of the mesh.
  double total = 0;
  for (const double a : faces.area) total += a;
  std::vector<uint32_t> order(faces.size());
  std::iota(order.begin(), order.end(), 0u);
  std::vector<double> key(faces.size());
  for (size_t f = 0; f < faces.size(); ++f) key[f] = -rounded(faces.area[f] / total);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return key[a] < key[b]; });

  // From each face without a number to all that are flat with it, across shared edges.
  std::vector<uint32_t> patch(faces.size(), kNone);
  std::vector<uint32_t> front;
  count = 0;
  for (const uint32_t seed : order) {
    if (patch[seed] != kNone) continue;
    patch[seed] = count;
    front.assign(1, seed);
    while (!front.empty()) {
      const uint32_t f = front.back();
      front.pop_back();
      for (const uint32_t g : faces.across[f])
        if (g != kNone && patch[g] == kNone &&
            angle_between(faces.normal[seed], faces.normal[g]) < kFlatAngle) {
          patch[g] = count;
          front.push_back(g);
        }
    }
    ++count;
  }
  return patch;
}

/// The border that two clusters share.
struct Border {
  uint32_t other = 0;
  double soft = 0, hard = 0;  ///< metres, below and above the crease angle
};

/// A merge of two clusters, `a` the one with the lower number, as they were in these versions.
struct Candidate {
  double cost;
  uint32_t a, b, version_a, version_b;
  friend bool operator>(const Candidate& p, const Candidate& q) {
    return std::tie(p.cost, p.a, p.b) > std::tie(q.cost, q.a, q.b);
  }
};

/// A candidate and the cluster that has it in its heap.
struct Proposal {
  Candidate candidate;
  uint32_t owner;
  friend bool operator>(const Proposal& p, const Proposal& q) { return p.candidate > q.candidate; }
};

/// Proposals, the cheapest first. Costs come in steps: each has a heap of its own, which a
/// processor's cache holds where one of all would not fit.
class Proposals {
 public:
  bool empty() const { return by_cost_.empty(); }
  void push(const Proposal& proposal) {
    std::vector<Proposal>& heap = by_cost_[proposal.candidate.cost];
    heap.push_back(proposal);
    std::ranges::push_heap(heap, std::greater<>());
  }
  Proposal pop() {
    const auto cheapest = by_cost_.begin();
    std::vector<Proposal>& heap = cheapest->second;
    std::ranges::pop_heap(heap, std::greater<>());
    const Proposal out = heap.back();
    heap.pop_back();
    if (heap.empty()) by_cost_.erase(cheapest);
    return out;
  }

 private:
  std::map<double, std::vector<Proposal>> by_cost_;
};

struct Cluster {
  DVec3 normal_sum;  ///< area-weighted
  double area = 0, perimeter = 0;
  std::vector<DVec3> normals;   ///< of its patches, those in the midst of others left out
  std::vector<Border> borders;  ///< sorted by `other`
  /// Clusters that it may merge with, found when it last changed: a heap with the cheapest on top.
  std::vector<Candidate> candidates;
  std::vector<uint32_t> patches;
  size_t most_normals = kManyNormals;  ///< with more, some are left out
};

/// Leaves out normals that lie between others, as seen along the axis, from which all are less than
/// a right angle away. A direction within such an angle of some normals is within that angle of all
/// normals between them, too: the outermost normals speak for all.
void keep_outermost(std::vector<DVec3>& normals, DVec3 axis) {
  // On the plane across the axis great circles are straight lines: the outermost normals are the
  // corners of the convex hull, made by Andrew's monotone chains.
  struct Point {
    double x, y;
    DVec3 normal;
  };
  const DVec3 across =
      normalize(cross(axis, std::abs(axis.x) < 0.9 ? DVec3{1, 0, 0} : DVec3{0, 1, 0}));
  const DVec3 third = cross(axis, across);
  std::vector<Point> points;
  for (const DVec3& n : normals) {
    const double depth = dot(n, axis);
    points.push_back({dot(n, across) / depth, dot(n, third) / depth, n});
  }
  std::ranges::sort(points, [](const Point& a, const Point& b) {
    return std::tie(a.x, a.y) < std::tie(b.x, b.y);
  });
  // Left of the line from a to b, or on it. What is left out may be outside of it by rounding
  // alone: the points are at most 5 from the middle (kSurelyInFront).
  const auto is_inside = [](const Point& a, const Point& p, const Point& b) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > -1e-14;
  };
  normals.clear();
  for (const bool lower : {true, false}) {
    std::vector<Point> chain;
    for (const Point& p : points) {
      while (chain.size() > 1 && is_inside(chain[chain.size() - 2], chain.back(), p))
        chain.pop_back();
      chain.push_back(p);
    }
    for (const Point& p : chain) normals.push_back(p.normal);
    if (lower) std::ranges::reverse(points);
  }
}

class Merger {
 public:
  Merger(const Faces& faces, const std::vector<uint32_t>& patch, uint32_t count, double max_angle)
      : clusters_(count), version_(count, 0), cos_max_(std::cos(max_angle)) {
    add_faces(faces, patch);
    add_borders(faces, patch);
    for (const Cluster& c : clusters_) total_area_ += c.area;
  }

  bool run(const Progress& progress) {
    for (uint32_t c = 0; c < clusters_.size(); ++c) {
      for (const Border& b : clusters_[c].borders)
        if (c < b.other) propose(c, b);
      std::ranges::make_heap(clusters_[c].candidates, std::greater<>());
      queue_cheapest(c);
    }
    uint32_t steps = 0;
    while (!queue_.empty()) {
      if ((++steps & 1023u) == 0 && progress.cancelled()) return false;
      const auto [best, owner] = queue_.pop();
      const uint32_t version = owner == best.a ? best.version_a : best.version_b;
      if (!is_now(owner, version)) continue;  // with all that it had proposed
      drop_cheapest(owner);
      if (is_now(best.a, best.version_a) && is_now(best.b, best.version_b) && fits(best.a, best.b))
        merge(best.a, best.b);
      else
        queue_cheapest(owner);
    }
    return true;
  }

  const std::vector<Cluster>& clusters() const { return clusters_; }

 private:
  void add_faces(const Faces& faces, const std::vector<uint32_t>& patch) {
    for (uint32_t f = 0; f < faces.size(); ++f) {
      Cluster& c = clusters_[patch[f]];
      c.normal_sum = c.normal_sum + faces.normal[f] * faces.area[f];
      c.area += faces.area[f];
    }
    for (uint32_t c = 0; c < clusters_.size(); ++c) {
      clusters_[c].normals = {normalize(clusters_[c].normal_sum)};
      clusters_[c].patches = {c};
    }
  }

  void add_borders(const Faces& faces, const std::vector<uint32_t>& patch) {
    for (uint32_t f = 0; f < faces.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const double l = length(faces.corners[f][(k + 1) % 3] - faces.corners[f][k]);
        const uint32_t g = faces.across[f][k];
        Cluster& c = clusters_[patch[f]];
        if (g != kNone && patch[g] == patch[f]) continue;
        c.perimeter += l;
        if (g == kNone) continue;
        const bool soft = angle_between(faces.normal[f], faces.normal[g]) < kCreaseAngle;
        c.borders.push_back({patch[g], soft ? l : 0, soft ? 0 : l});
      }
    for (Cluster& c : clusters_) combine(c.borders);
  }

  static void combine(std::vector<Border>& borders) {
    std::stable_sort(borders.begin(), borders.end(),
                     [](const Border& a, const Border& b) { return a.other < b.other; });
    size_t kept = 0;
    for (size_t i = 0; i < borders.size(); ++i)
      if (kept > 0 && borders[kept - 1].other == borders[i].other) {
        borders[kept - 1].soft += borders[i].soft;
        borders[kept - 1].hard += borders[i].hard;
      } else {
        borders[kept++] = borders[i];
      }
    borders.resize(kept);
  }

  bool is_now(uint32_t cluster, uint32_t version) const { return version_[cluster] == version; }

  /// The cheapest of what a cluster proposes waits for its turn among those of all clusters.
  void queue_cheapest(uint32_t c) {
    std::vector<Candidate>& own = clusters_[c].candidates;
    if (!own.empty()) queue_.push({own.front(), c});
  }
  void drop_cheapest(uint32_t c) {
    std::vector<Candidate>& own = clusters_[c].candidates;
    std::ranges::pop_heap(own, std::greater<>());
    own.pop_back();
  }

  /// Every patch of both stays within the largest angle of the common axis.
  bool fits(uint32_t a, uint32_t b) const {
    const DVec3 axis = normalize(clusters_[a].normal_sum + clusters_[b].normal_sum);
    for (const uint32_t c : {a, b})
      for (const DVec3& n : clusters_[c].normals)
        if (dot(n, axis) < cos_max_) return false;
    return true;
  }

  /// The cost is the flatness that a merge loses, sum A (1 - n . axis) = A - |sum A n|, plus the
  /// smaller area times a measure of the outline: ragged charts pack badly and have long seams.
  void propose(uint32_t a, const Border& border) {
    if (border.soft <= border.hard) return;
    const Cluster &p = clusters_[a], &q = clusters_[border.other];
    const DVec3 sum = p.normal_sum + q.normal_sum;
    const DVec3 axis = normalize(sum);
    if (dot(p.normals.front(), axis) < cos_max_ || dot(q.normals.front(), axis) < cos_max_) return;
    const double lost = (p.area + q.area - length(sum)) - (p.area - length(p.normal_sum)) -
                        (q.area - length(q.normal_sum));
    const double outline = p.perimeter + q.perimeter - 2 * (border.soft + border.hard);
    const double shape = outline * outline / (16 * (p.area + q.area));
    const double cost = (lost + shape * std::min(p.area, q.area)) / total_area_;
    const uint32_t b = border.other;
    clusters_[a].candidates.push_back({rounded(cost), std::min(a, b), std::max(a, b),
                                       version_[std::min(a, b)], version_[std::max(a, b)]});
  }

  /// The smaller one goes into the larger one.
  void merge(uint32_t a, uint32_t b) {
    if (clusters_[a].borders.size() < clusters_[b].borders.size()) std::swap(a, b);
    Cluster &p = clusters_[a], &q = clusters_[b];
    const auto shared = std::find_if(p.borders.begin(), p.borders.end(),
                                     [&](const Border& x) { return x.other == b; });
    p.perimeter += q.perimeter - 2 * (shared->soft + shared->hard);
    p.borders.erase(shared);
    for (const Border& x : q.borders)
      if (x.other != a) p.borders.push_back(x);
    combine(p.borders);
    p.normal_sum = p.normal_sum + q.normal_sum;
    p.area += q.area;
    p.normals.insert(p.normals.end(), q.normals.begin(), q.normals.end());
    if (p.normals.size() > p.most_normals && cos_max_ > kSurelyInFront) {
      keep_outermost(p.normals, normalize(p.normal_sum));
      p.most_normals = std::max(kManyNormals, 2 * p.normals.size());
    }
    p.patches.insert(p.patches.end(), q.patches.begin(), q.patches.end());
    ++version_[a];
    version_[b] = kNone;
    for (const Border& x : q.borders)
      if (x.other != a) rename(clusters_[x.other].borders, b, a);
    q = Cluster{};
    p.candidates.clear();
    for (const Border& x : p.borders) propose(a, x);
    std::ranges::make_heap(p.candidates, std::greater<>());
    queue_cheapest(a);
  }

  static void rename(std::vector<Border>& borders, uint32_t from, uint32_t to) {
    for (Border& x : borders)
      if (x.other == from) x.other = to;
    combine(borders);
  }

  std::vector<Cluster> clusters_;
  std::vector<uint32_t> version_;  ///< of each cluster, how often it has grown; kNone: it is gone
  Proposals queue_;  ///< of each cluster the cheapest; also of some that have changed since
  double cos_max_;
  double total_area_ = 0;
};

/// The connected parts of all charts, in the order of their first faces.
std::vector<ChartFaces> collect_charts(const Faces& faces, const std::vector<uint32_t>& chart) {
  std::vector<bool> seen(faces.size());
  std::vector<ChartFaces> charts;
  std::vector<uint32_t> front;
  for (uint32_t seed = 0; seed < faces.size(); ++seed) {
    if (seen[seed]) continue;
    seen[seed] = true;
    front.assign(1, seed);
    charts.emplace_back();
    while (!front.empty()) {
      const uint32_t f = front.back();
      front.pop_back();
      charts.back().push_back(f);
      for (const uint32_t g : faces.across[f])
        if (g != kNone && !seen[g] && chart[g] == chart[f]) {
          seen[g] = true;
          front.push_back(g);
        }
    }
    std::sort(charts.back().begin(), charts.back().end());
  }
  return charts;
}

}  // namespace

DVec3 chart_axis(const Faces& faces, const ChartFaces& chart) {
  DVec3 sum;
  for (const uint32_t f : chart) sum = sum + faces.normal[f] * faces.area[f];
  return normalize(sum);
}

std::vector<ChartFaces> grow_charts(const Faces& faces, double max_angle,
                                    const Progress& progress) {
  uint32_t patch_count = 0;
  const std::vector<uint32_t> patch = flat_patches(faces, patch_count);
  Merger merger(faces, patch, patch_count, max_angle);
  if (!merger.run(progress)) return {};

  std::vector<uint32_t> chart_of_patch(patch_count, kNone);
  for (uint32_t c = 0; c < merger.clusters().size(); ++c)
    for (const uint32_t p : merger.clusters()[c].patches) chart_of_patch[p] = c;
  std::vector<uint32_t> chart_of_face(faces.size());
  for (uint32_t f = 0; f < faces.size(); ++f) chart_of_face[f] = chart_of_patch[patch[f]];
  smooth_outlines(faces, patch, max_angle, chart_of_face);
  return collect_charts(faces, chart_of_face);
}

std::vector<ChartFaces> connected_parts(const Faces& faces, const ChartFaces& set) {
  std::unordered_map<uint32_t, uint32_t> part;
  for (const uint32_t f : set) part.emplace(f, kNone);
  // Flood fill from each face that has no part yet.
  std::vector<ChartFaces> parts;
  std::vector<uint32_t> front;
  for (const uint32_t seed : set) {
    if (part[seed] != kNone) continue;
    part[seed] = uint32_t(parts.size());
    parts.emplace_back();
    front.assign(1, seed);
    while (!front.empty()) {
      const uint32_t f = front.back();
      front.pop_back();
      parts.back().push_back(f);
      for (const uint32_t g : faces.across[f]) {
        const auto found = part.find(g);
        if (found == part.end() || found->second != kNone) continue;
        found->second = uint32_t(parts.size() - 1);
        front.push_back(g);
      }
    }
    std::sort(parts.back().begin(), parts.back().end());
  }
  return parts;
}

}  // namespace luxel::atlas
