#include "solve/hierarchical/irradiance.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/random.h"
#include "base/warp.h"
#include "solve/hierarchical/surface.h"
#include "transport/direct_light.h"
#include "transport/point_form_factor.h"

namespace luxel::hierarchical {
namespace {

/// Beyond so many faces the background is looked for by rays instead of as what no face hides.
constexpr size_t kMostFacesBeforeSky = 4096;
constexpr uint32_t kSkyRays = 1024;
/// What a cluster's surfaces hide of each other, at most, as a share of its light.
constexpr double kOwnShadow = 0.1;
/// Elements are taken apart for their light no further than this often.
constexpr int kMostCuts = 6;

/// A part of a source, with radiosity at its corners.
struct Part {
  std::array<DVec3, 4> corner;
  std::array<Rgb, 4> radiosity;
  uint32_t corners = 4;

  PolygonView polygon() const { return {corner.data(), corners}; }
};

/// What one point gathers.
class Gathering {
 public:
  Gathering(const Solution& s, const trace::RayTracer& tracer, double limit, bool count_all)
      : s_(s), tracer_(tracer), limit_(limit), count_all_(count_all) {
    casts_.resize(s.blockers.all.size());
  }

  /// `list`, unless null, gets what is seen of each face.
  Rgb from_faces(const Receiver& at, std::vector<Seen>* list) {
    at_ = at, list_ = list;
    horizon_ = {at.geometric_normal, dot(at.geometric_normal, at.position)};
    covered_ = 0, sum_ = {};
    if (s_.tree.size() > 0) visit(0);
    return sum_;
  }
  /// The share of the hemisphere that faces cover, when it was asked to count all of them.
  double covered() const { return covered_; }

 private:
  void visit(uint32_t id) {
    if (!s_.tree.is_cluster(id)) {
      visit_root(id);
      return;
    }
    const Cluster& c = s_.tree.clusters[id];
    const DVec3& n = at_.geometric_normal;
    const DVec3 highest{n.x > 0 ? c.upper.x : c.lower.x, n.y > 0 ? c.upper.y : c.lower.y,
                        n.z > 0 ? c.upper.z : c.lower.z};
    if (horizon_.height(highest) <= s_.blockers.slack_m) return;
    if (!count_all_ && !list_ && is_far(id)) return;
    for (const uint32_t child : c.child) visit(child);
  }

  /// Takes a cluster as one lamp where it is so far, and so little comes from it, that its size
  /// makes no difference, and nothing else stands before it.
  bool is_far(uint32_t id) {
    const Cluster& c = s_.tree.clusters[id];
    const DVec3 d = c.centre - at_.position;
    const double distance = length(d), part = c.radius_m / distance;
    if (part > 0.25) return false;
    const Vec3 direction = to_float(d * (1 / distance));
    const Rgb light = max(Rgb{}, s_.light.clusters[id].sent.at(-direction)) *
                      float(1 / (kPiDouble * distance * distance));
    if (double(max_component(light)) * (kOwnShadow + 2 * part * part) > limit_) return false;
    const double cosine = dot(d, at_.normal) / distance;
    if (cosine < part) return false;  // the horizon may cut it
    find_in_cone(s_.blockers, at_.position, c.centre, c.radius_m, first_);
    for (const uint32_t f : first_)
      if (f != at_.face && !is_part_of(f, c)) return false;
    sum_ += light * float(cosine);
    return true;
  }

  bool is_part_of(uint32_t face, const Cluster& c) const {
    for (uint32_t r = s_.tree.first_root[face]; r < s_.tree.first_root[face + 1]; ++r)
      if (s_.tree.rank[r] < c.first || s_.tree.rank[r] >= c.end) return false;
    return true;
  }

  void visit_root(uint32_t id) {
    const Element& e = s_.tree.element(id);
    const Face& face = s_.faces.faces[e.face];
    if (e.face == at_.face) return;
    const double height = face.plane.height(at_.position);
    if (std::abs(height) <= 1e-12) return;
    const bool shines = height > 0 || face.two_sided;
    const ElementLight& light = s_.light.elements[id - s_.tree.clusters.size()];
    if (!count_all_ && (!shines || (light.most == 0 && !list_))) return;
    turned_ = height < 0;
    Part part;
    part.corners = e.corners;
    for (uint32_t k = 0; k < e.corners; ++k) part.corner[k] = e.corner[k];
    const Polygon polygon = above_horizon(part);
    if (polygon.empty()) return;
    find_before(s_.blockers, at_.position, polygon, first_);
    std::erase(first_, e.face), std::erase(first_, at_.face);
    const transport::SeenFactor seen = look(polygon, first_);
    covered_ += seen.visible;
    if (!(seen.visible > 0) || !shines) return;
    const std::vector<uint32_t> blockers = casters(first_);
    const Rgb before = sum_;
    add_element(id - s_.tree.clusters.size(), seen, blockers);
    if (list_) list_->push_back({e.face, seen.visible, seen.whole, sum_ - before});
  }

  Polygon above_horizon(const Part& part) const {
    Polygon out = transport::clip_above(part.polygon(), horizon_, s_.blockers.slack_m * 1e-3);
    if (turned_) std::reverse(out.begin(), out.end());
    return out;
  }

  transport::SeenFactor look(PolygonView polygon, std::span<const uint32_t> blockers) {
    if (blockers.empty()) {
      const double whole = transport::point_to_polygon(at_.position, at_.normal, polygon);
      return {whole, whole};
    }
    for (const uint32_t b : blockers) casts_[b] = 0;
    return transport::visible_point_factor(at_.position, at_.normal, polygon, s_.blockers.all,
                                           blockers, s_.blockers.slack_m * 1e-3, casts_, scratch_);
  }

  /// Of the blockers of the last look those whose shadows fell on what was looked at: no others'
  /// fall on a part of it.
  std::vector<uint32_t> casters(std::span<const uint32_t> blockers) const {
    std::vector<uint32_t> out;
    for (const uint32_t b : blockers)
      if (casts_[b]) out.push_back(b);
    return out;
  }

  /// An element, from what is seen of it: as a whole, or its parts.
  void add_element(size_t index, const transport::SeenFactor& seen,
                   std::span<const uint32_t> blockers) {
    const Element& e = s_.tree.elements[index];
    const ElementLight& light = s_.light.elements[index];
    if (e.is_leaf() || double(light.rough) * seen.whole <= limit_) {
      Part part;
      part.corner = e.corner, part.corners = e.corners, part.radiosity = light.shining;
      add_part(part, seen, blockers, 0);
      return;
    }
    for (uint32_t c = e.child; c < e.child + 4; ++c) {
      Part part;
      part.corner = s_.tree.elements[c].corner, part.corners = e.corners;
      const Polygon polygon = above_horizon(part);
      if (polygon.empty()) continue;
      const transport::SeenFactor there = look(polygon, blockers);
      if (there.visible > 0) add_element(c, there, casters(blockers));
    }
  }

  /// Radiosity is linear over a part. As the point sees it, its mean is that of Gauss's points,
  /// each with the weight of the kernel there, where the part is far or differs little; else its
  /// quarters are looked at.
  void add_part(const Part& part, const transport::SeenFactor& seen,
                std::span<const uint32_t> blockers, int cuts) {
    Rgb least{INFINITY, INFINITY, INFINITY}, most{};
    DVec3 middle;
    for (uint32_t k = 0; k < part.corners; ++k) {
      least = min(least, part.radiosity[k]), most = max(most, part.radiosity[k]);
      middle += part.corner[k] * (1.0 / part.corners);
    }
    const double size = length(part.corner[0] - middle);
    const double nearness = size / std::max(length(middle - at_.position), 1e-9);
    const double unsure = 0.2 * seen.whole * std::min(1.0, nearness * nearness) +
                          0.5 * std::min(seen.visible, seen.whole - seen.visible);
    if (double(max_component(most - least)) * unsure <= limit_ || cuts == kMostCuts) {
      sum_ += max(radiosity_seen(part, middle), Rgb{}) * float(seen.visible);
      return;
    }
    for (uint32_t k = 0; k < 4; ++k) {
      const Part quarter{part_of(part.corner, part.corners, k),
                         part_of(part.radiosity, part.corners, k), part.corners};
      const Polygon polygon = above_horizon(quarter);
      if (polygon.empty()) continue;
      const transport::SeenFactor there = look(polygon, blockers);
      if (there.visible > 0) add_part(quarter, there, casters(blockers), cuts + 1);
    }
  }

  /// The mean radiosity of a part, weighted by cos / r^2 on the way to the receiver.
  Rgb radiosity_seen(const Part& part, DVec3 middle) const {
    // From the middle to Gauss's points: 1 / sqrt 3 of the way to a quadrilateral's corners, half
    // of it to a triangle's.
    const double inside = part.corners == 4 ? 0.57735027 : 0.5;
    Rgb mean{}, sum{};
    for (uint32_t k = 0; k < part.corners; ++k)
      mean += part.radiosity[k] * (1 / float(part.corners));
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

  const Solution& s_;
  const trace::RayTracer& tracer_;
  double limit_ = 0;  ///< what may be lost of one source [W/m^2]
  bool count_all_ = false;
  Receiver at_;
  Plane horizon_;
  bool turned_ = false;  ///< the source shows its back
  Rgb sum_{};
  double covered_ = 0;
  std::vector<Seen>* list_ = nullptr;
  std::vector<uint32_t> first_;
  std::vector<uint8_t> casts_;
  transport::VisibilityScratch scratch_;
};

double limit_of(const Solution& s, const PointParams& params) {
  return params.tolerance * double(max_component(totals_of(s).irradiance));
}

/// E of the background by rays, the same directions everywhere.
float sky_by_rays(const Solution& s, const trace::RayTracer& tracer, const Receiver& at) {
  const Vec3 n = to_float(at.normal), g = to_float(at.geometric_normal);
  const auto frame = frame_around(n);
  const Vec3 from = trace::offset_origin(to_float(at.position), g, s.diagonal_m);
  std::vector<trace::Ray> rays;
  for (uint32_t k = 0; k < kSkyRays; ++k) {
    const Vec3 d = frame.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, 5)));
    if (dot(d, g) > 0) rays.push_back({from, 0, d, INFINITY});
  }
  std::vector<uint8_t> blocked(rays.size());
  tracer.occluded(rays, blocked);
  return float(std::count(blocked.begin(), blocked.end(), 0)) / kSkyRays;
}

/// E of lamps without area.
Result<std::vector<Rgb>> from_lamps(const scene::Scene& scene, const trace::RayTracer& tracer,
                                    const Lamps& lamps, std::span<const Receiver> receivers,
                                    Progress& progress) {
  if (lamps.punctual.punctual.empty()) return std::vector<Rgb>(receivers.size());
  transport::Elements points;
  for (const Receiver& r : receivers) {
    points.position.push_back(to_float(r.position));
    points.normal.push_back(to_float(r.normal));
    points.geometric_normal.push_back(to_float(r.geometric_normal));
    points.reflectance.push_back({});
  }
  LUXEL_TRY(
      transport::DirectLight direct,
      transport::direct_light(scene, points, lamps.punctual, tracer, {256, 1, true}, progress));
  return std::move(direct.irradiance);
}

}  // namespace

Result<std::vector<Rgb>> irradiance_at(const Solution& s, const scene::Scene& scene,
                                       const trace::RayTracer& tracer,
                                       std::span<const Receiver> receivers,
                                       const PointParams& params, Progress& progress) {
  const Lamps lamps = lamps_of(scene);
  LUXEL_TRY(std::vector<Rgb> out, from_lamps(scene, tracer, lamps, receivers, progress));
  const bool has_sky = max_component(lamps.background) > 0;
  const bool count_all = has_sky && s.faces.size() <= kMostFacesBeforeSky;
  const double limit = limit_of(s, params);
  progress.begin("irradiance", receivers.size());
  parallel_for(receivers.size(), 32, [&](size_t begin, size_t end) {
    Gathering gathering(s, tracer, limit, count_all);
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      out[i] += gathering.from_faces(receivers[i], nullptr);
      if (!has_sky) continue;
      const double sky = count_all ? std::max(0.0, 1 - gathering.covered())
                                   : double(sky_by_rays(s, tracer, receivers[i]));
      out[i] += lamps.background * (kPi * float(sky));
    }
    progress.advance(end - begin);
  });
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "cancelled");
  return out;
}

std::vector<Seen> sources_at(const Solution& s, const trace::RayTracer& tracer,
                             const Receiver& receiver, const PointParams& params) {
  std::vector<Seen> out;
  Gathering(s, tracer, limit_of(s, params), false).from_faces(receiver, &out);
  std::stable_sort(out.begin(), out.end(), [](const Seen& a, const Seen& b) {
    return luminance(a.irradiance) > luminance(b.irradiance);
  });
  return out;
}

Backprojection backproject(const Solution& s, const Receiver& receiver, uint32_t face) {
  Backprojection out;
  const Face& f = s.faces.faces[face];
  const Plane horizon{receiver.geometric_normal, dot(receiver.geometric_normal, receiver.position)};
  out.source = transport::clip_above(f.corners, horizon, s.blockers.slack_m * 1e-3);
  if (out.source.empty()) return out;
  if (f.plane.height(receiver.position) < 0) std::reverse(out.source.begin(), out.source.end());
  std::vector<uint32_t> blockers;
  find_before(s.blockers, receiver.position, out.source, blockers);
  std::erase(blockers, face), std::erase(blockers, receiver.face);
  std::vector<uint8_t> casts(s.blockers.all.size());
  transport::VisibilityScratch scratch;
  transport::visible_point_factor(receiver.position, receiver.normal, out.source, s.blockers.all,
                                  blockers, s.blockers.slack_m * 1e-3, casts, scratch);
  for (size_t k = 0; k < scratch.visible.size(); ++k) {
    out.visible.emplace_back();
    for (const DVec3& p : scratch.visible[k]) out.visible.back().push_back(p + receiver.position);
  }
  return out;
}

Receiver receiver_at(const Solution& s, const scene::Scene& scene, const trace::RayTracer& tracer,
                     uint32_t face, DVec3 place) {
  const Face& f = s.faces.faces[face];
  if (!f.curved) return {place, f.plane.normal, f.plane.normal, face};
  const transport::SmoothPoint p =
      transport::smooth_point(scene, surface_point(scene, s.faces, tracer, face, place));
  return {to_double(p.position), to_double(p.normal), to_double(p.geometric_normal), face};
}

}  // namespace luxel::hierarchical
