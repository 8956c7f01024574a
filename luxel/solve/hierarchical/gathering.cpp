#include "luxel/solve/hierarchical/gathering.h"

#include <algorithm>

#include "luxel/viewfactor/point_form_factor.h"

namespace luxel::hierarchical {
namespace {

/// Rays to a cluster find surfaces that turn their backs, too: of a closed solid, half of them.
constexpr double kRaysForSides = 2;
/// More rays than this go to the parts of a cluster, where each knows more about what it hits.
constexpr double kMostClusterRays = 16;
/// A cluster's radius over its distance, at most. Distances to its surfaces then differ by up to a
/// quarter, 1 / r^2 by up to (4/3)^2. Larger saves rays in the open, and errs close by.
constexpr double kMostRadius = 0.25;
/// Elements are taken apart for their light no further than this often: into parts of 1/64 of their
/// length. A limit for points that touch a source, where quarters never become small.
constexpr int kGatheringMostCuts = 6;
/// So few rays cost less than to find out what stands in between.
constexpr double kFewRays = 8;
/// Sources behind masks are looked at by rays whatever is at stake; this bounds their number.
constexpr double kMostRays = 4096;
/// A ray is a single look that sees all of a source or nothing: its standard deviation is at most
/// one half of the source's light.
constexpr double kOneRay = 0.5;
/// The error of Gauss's points over a part, per (size / distance)^2 and difference of radiosity:
/// see add_part. Larger cuts parts into quarters that add nothing; smaller leaves the light of
/// sources close by too even.
constexpr double kQuadrature = 0.2;
/// The largest difference between the radiosity of the seen piece of a part in half shadow and the
/// mean of all of the part: half of the difference between its corners.
constexpr double kHalfSeen = 0.5;
/// Cost of cutting the shadows of k blockers out of a source, in rays: about kCutCost k^2.
constexpr double kCutCost = 0.5;

}  // namespace

/// A part of a source, with radiosity at its corners.
struct Gathering::Part {
  std::array<DVec3, 4> corner;
  std::array<Rgb, 4> radiosity;
  uint32_t corners = 4;

  PolygonView polygon() const { return {corner.data(), corners}; }
};

Rgb Gathering::from_faces(const Receiver& at, std::vector<Seen>* list) {
  at_ = at, list_ = list;
  horizon_ = {at.geometric_normal, dot(at.geometric_normal, at.position)};
  covered_ = 0, sum_ = {};
  if (s_.tree.size() > 0) visit(0);
  return sum_;
}

void Gathering::visit(uint32_t id) {
  if (!s_.tree.is_cluster(id)) {
    visit_root(id);
    return;
  }
  const Cluster& c = s_.tree.clusters[id];
  const DVec3& n = at_.geometric_normal;
  const DVec3 highest{n.x > 0 ? c.upper.x : c.lower.x, n.y > 0 ? c.upper.y : c.lower.y,
                      n.z > 0 ? c.upper.z : c.lower.z};
  if (horizon_.height(highest) <= s_.blockers.slack_m) return;
  if (params_.sky == 0 && !list_ && take_cluster(id)) return;
  for (const uint32_t child : c.child) visit(child);
}

/// Rays until the error of a source that brings `light` is at most the limit. Of n places spread
/// evenly over a source, each in a cell of its own, a straight border of a shadow crosses about
/// sqrt(n) cells. Each of these errs by 1/n of the light, independently, so that all err by
/// sqrt(sqrt n) / n = n^-3/4 of the error of one place. Solved for n.
double Gathering::rays_for(double light) const {
  if (kOneRay * light <= params_.limit) return 1;
  return std::ceil(std::pow(kOneRay * light / params_.limit, 4.0 / 3));
}

/// The most light that an element brings, plus the light of the sky that it hides [W/m^2].
double Gathering::at_stake(size_t index, double whole, bool shines) const {
  return whole * ((shines ? double(s_.light.elements[index].most) : 0) + params_.sky);
}

/// Takes a cluster by rays where it is so far, and so little comes from it, that few of them do.
bool Gathering::take_cluster(uint32_t id) {
  const Cluster& c = s_.tree.clusters[id];
  const DVec3 d = c.centre - at_.position;
  const double distance = length(d), part = c.radius_m / distance;
  if (part > kMostRadius) return false;
  const double power = sampler_.power_of(id);
  if (power == 0) return true;
  const double most = power / (kPiDouble * distance * distance);
  const double rays = kRaysForSides * rays_for(most);
  if (rays > kMostClusterRays) return false;
  sum_ += sampler_.irradiance_from_cluster(at_, id, uint32_t(rays));
  return true;
}

void Gathering::visit_root(uint32_t id) {
  const Element& e = s_.tree.element(id);
  const Face& face = s_.faces.faces[e.face];
  if (e.face == at_.face) return;
  const double height = face.plane.height(at_.position);
  if (std::abs(height) <= 1e-12) return;
  const bool shines = height > 0 || face.two_sided;
  const size_t index = id - s_.tree.clusters.size();
  const float most = s_.light.elements[index].most;
  if (params_.sky == 0 && (!shines || (most == 0 && !list_))) return;
  // The light at stake: the form factor, were nothing in between, and the rays that it is worth.
  turned_ = height < 0;
  const PolygonView polygon = above_horizon(e.polygon());
  if (polygon.empty()) return;
  const double whole = viewfactor::point_to_polygon(at_.position, at_.normal, polygon);
  if (!(whole > 0)) return;
  const double rays = list_ ? INFINITY : rays_for(at_stake(index, whole, shines));
  if (rays <= kFewRays) {
    look_by_rays(index, whole, shines);
    return;
  }
  // Blockers in between decide which is cheaper: rays, or cutting shadows out.
  find_before(s_.blockers, at_.position, polygon, first_);
  std::erase(first_, e.face), std::erase(first_, at_.face);
  const auto count = double(first_.size());
  const Rgb light_before = sum_;
  const double covered_before = covered_;
  if (rays < kCutCost * count * count || has_holes(s_.faces, first_))
    look_by_rays(index, whole, shines);
  else
    look_exactly(index, polygon, whole, shines);
  const double seen = covered_ - covered_before;
  if (list_ && seen > 0 && shines) list_->push_back({e.face, seen, whole, sum_ - light_before});
}

void Gathering::look_exactly(size_t index, PolygonView polygon, double whole, bool shines) {
  const viewfactor::SeenFactor seen =
      first_.empty() ? viewfactor::SeenFactor{whole, whole} : look(polygon, first_);
  covered_ += seen.visible;
  if (!(seen.visible > 0) || !shines) return;
  const std::vector<uint32_t> blockers = casters(first_);
  add_element(index, seen, blockers);
}

/// `whole`: the factor to the element, were nothing in between.
void Gathering::look_by_rays(size_t index, double whole, bool shines) {
  const Element& e = s_.tree.elements[index];
  const ElementLight& light = s_.light.elements[index];
  if (shines && !e.is_leaf() && double(light.rough) * whole > params_.limit) {
    for (uint32_t c = e.child; c < e.child + 4; ++c) {
      const PolygonView polygon = above_horizon(s_.tree.elements[c].polygon());
      if (polygon.empty()) continue;
      const double part = viewfactor::point_to_polygon(at_.position, at_.normal, polygon);
      if (part > 0) look_by_rays(c, part, shines);
    }
    return;
  }
  const double rays = rays_for(at_stake(index, whole, shines));
  const SourceSampler::Sample sample =
      sampler_.sample_element(at_, index, uint32_t(std::min(rays, kMostRays)));
  covered_ += whole * sample.share;
  if (shines) sum_ += sample.radiosity * float(whole);
}

/// The part of a polygon above the horizon, its front towards the receiver. Valid until the next
/// call.
PolygonView Gathering::above_horizon(PolygonView polygon) {
  viewfactor::clip_above(polygon, horizon_, s_.blockers.slack_m * 1e-3, above_);
  if (turned_) std::reverse(above_.begin(), above_.end());
  return above_;
}

viewfactor::SeenFactor Gathering::look(PolygonView polygon, std::span<const uint32_t> blockers) {
  if (blockers.empty()) {
    const double whole = viewfactor::point_to_polygon(at_.position, at_.normal, polygon);
    return {whole, whole};
  }
  for (const uint32_t b : blockers) casts_[b] = 0;
  return viewfactor::visible_point_factor(at_.position, at_.normal, polygon,
                                          {s_.blockers.all, blockers}, s_.blockers.slack_m * 1e-3,
                                          casts_, scratch_);
}

/// The blockers of the last look whose shadows fell on what was looked at: no others' fall on a
/// part of it.
std::vector<uint32_t> Gathering::casters(std::span<const uint32_t> blockers) const {
  std::vector<uint32_t> out;
  for (const uint32_t b : blockers)
    if (casts_[b]) out.push_back(b);
  return out;
}

/// Calls take(what is seen, by whom it is hidden) for a part of what was looked at, where anything
/// is.
template <class Take>
void Gathering::look_again(PolygonView part, std::span<const uint32_t> blockers, const Take& take) {
  const PolygonView polygon = above_horizon(part);
  if (polygon.empty()) return;
  const viewfactor::SeenFactor there = look(polygon, blockers);
  if (there.visible > 0) take(there, casters(blockers));
}

/// An element, from what is seen of it: as a whole, or its parts.
void Gathering::add_element(size_t index, const viewfactor::SeenFactor& seen,
                            std::span<const uint32_t> blockers) {
  const Element& e = s_.tree.elements[index];
  const ElementLight& light = s_.light.elements[index];
  // Leaves' pieces have the same light in the mean.
  const double nearness = e.is_leaf() ? e.radius_m / length(e.centre - at_.position) : 1;
  if (double(light.rough) * seen.whole * std::min(1.0, nearness) <= params_.limit) {
    add_part({e.corner, light.shining, e.corners}, seen, blockers, 0);
    return;
  }
  if (e.is_leaf()) {
    for (uint32_t k = s_.light.first_piece[index]; k < s_.light.first_piece[index + 1]; ++k) {
      const Part part{s_.light.pieces[k].corner, s_.light.pieces[k].radiosity, 3};
      look_again(part.polygon(), blockers, [&](const auto& there, const auto& casters) {
        add_part(part, there, casters, 0);
      });
    }
    return;
  }
  for (uint32_t c = e.child; c < e.child + 4; ++c)
    look_again(s_.tree.elements[c].polygon(), blockers,
               [&](const auto& there, const auto& casters) { add_element(c, there, casters); });
}

/// Radiosity is linear over a part. As the point sees it, its mean is that of Gauss's points, each
/// with the weight of the kernel there, where the part is far or differs little; else its quarters
/// are looked at. Two things make that mean wrong. The kernel cos cos / r^2 varies over the part:
/// Gauss's points leave terms of the order of (size / distance)^2, of which kQuadrature is the
/// factor; a part that is nearer than it is large errs no more than that. And where a part is half
/// hidden, what is seen of it may be its bright or its dark half.
void Gathering::add_part(const Part& part, const viewfactor::SeenFactor& seen,
                         std::span<const uint32_t> blockers, int cuts) {
  Rgb least{INFINITY, INFINITY, INFINITY}, most{};
  DVec3 middle;
  for (uint32_t k = 0; k < part.corners; ++k) {
    least = min(least, part.radiosity[k]), most = max(most, part.radiosity[k]);
    middle += part.corner[k] * (1.0 / part.corners);
  }
  const double size = length(part.corner[0] - middle);
  const double nearness = size / std::max(length(middle - at_.position), 1e-9);
  const double unsure = kQuadrature * seen.whole * std::min(1.0, nearness * nearness) +
                        kHalfSeen * std::min(seen.visible, seen.whole - seen.visible);
  if (double(max_component(most - least)) * unsure <= params_.limit || cuts == kGatheringMostCuts) {
    sum_ += max(radiosity_seen(part, middle), Rgb{}) * float(seen.visible);
    return;
  }
  for (uint32_t k = 0; k < 4; ++k) {
    const Part quarter{part_of(part.corner, part.corners, k),
                       part_of(part.radiosity, part.corners, k), part.corners};
    look_again(quarter.polygon(), blockers, [&](const auto& there, const auto& casters) {
      add_part(quarter, there, casters, cuts + 1);
    });
  }
}

/// The mean radiosity of a part, weighted by cos / r^2 on the way to the receiver.
Rgb Gathering::radiosity_seen(const Part& part, DVec3 middle) const {
  // From the middle to Gauss's points: 1 / sqrt 3 of the way to a quadrilateral's corners, half
  // of it to a triangle's.
  const double inside = part.corners == 4 ? 0.57735027 : 0.5;
  Rgb mean{}, sum{};
  for (uint32_t k = 0; k < part.corners; ++k) mean += part.radiosity[k] * (1 / float(part.corners));
  float weight = 0;
  for (uint32_t k = 0; k < part.corners; ++k) {
    const DVec3 d = middle + (part.corner[k] - middle) * inside - at_.position;
    const double r2 = dot(d, d);
    // The source's own cosine is a height over r, and the height is the same for all points.
    const auto w = float(std::max(0.0, dot(d, at_.normal)) / (r2 * r2));
    sum += (mean + (part.radiosity[k] - mean) * float(inside)) * w, weight += w;
  }
  return weight > 0 ? sum / weight : mean;
}

}  // namespace luxel::hierarchical
