#include "luxel/atlas/charts.h"

#include <algorithm>
#include <numeric>
#include <queue>
#include <tuple>
#include <unordered_map>

#include "luxel/atlas/atlas.h"
#include "luxel/atlas/outline.h"

namespace luxel::atlas {
namespace {

constexpr double kFlatAngle = 0.01;    ///< faces this close to a patch's first face are coplanar
constexpr double kCreaseAngle = 0.75;  ///< light changes at a sharper edge: no chart crosses it

/// A size or cost in steps of one percent, so that symmetric candidates compare equal whatever the
/// unit of length did to their last digits. What is as good as nothing is one step, too.
double rounded(double share) { return std::floor(std::log2(std::max(share, 1e-14)) * 64 + 0.37); }

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

struct Cluster {
  DVec3 normal_sum;  ///< area-weighted
  double area = 0, perimeter = 0;
  std::vector<DVec3> normals;   ///< of its patches
  std::vector<Border> borders;  ///< sorted by `other`
  std::vector<uint32_t> patches;
  uint32_t version = 0;
  bool alive = true;
};

struct Candidate {
  double cost;
  uint32_t a, b, version_a, version_b;
  friend bool operator>(const Candidate& p, const Candidate& q) {
    return std::tie(p.cost, p.a, p.b) > std::tie(q.cost, q.a, q.b);
  }
};

class Merger {
 public:
  Merger(const Faces& faces, const std::vector<uint32_t>& patch, uint32_t count, double max_angle)
      : clusters_(count), cos_max_(std::cos(max_angle)) {
    add_faces(faces, patch);
    add_borders(faces, patch);
    for (const Cluster& c : clusters_) total_area_ += c.area;
  }

  bool run(const Progress& progress) {
    for (uint32_t c = 0; c < clusters_.size(); ++c)
      for (const Border& b : clusters_[c].borders)
        if (c < b.other) propose(c, b);
    uint32_t steps = 0;
    while (!queue_.empty()) {
      if ((++steps & 1023u) == 0 && progress.cancelled()) return false;
      const Candidate best = queue_.top();
      queue_.pop();
      if (fresh(best) && fits(best.a, best.b)) merge(best.a, best.b);
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

  bool fresh(const Candidate& c) const {
    return clusters_[c.a].alive && clusters_[c.b].alive && clusters_[c.a].version == c.version_a &&
           clusters_[c.b].version == c.version_b;
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
    queue_.push({rounded(cost), std::min(a, b), std::max(a, b), clusters_[std::min(a, b)].version,
                 clusters_[std::max(a, b)].version});
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
    p.patches.insert(p.patches.end(), q.patches.begin(), q.patches.end());
    ++p.version;
    for (const Border& x : q.borders)
      if (x.other != a) rename(clusters_[x.other].borders, b, a);
    q = Cluster{};
    q.alive = false;
    for (const Border& x : p.borders) propose(a, x);
  }

  static void rename(std::vector<Border>& borders, uint32_t from, uint32_t to) {
    for (Border& x : borders)
      if (x.other == from) x.other = to;
    combine(borders);
  }

  std::vector<Cluster> clusters_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
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
