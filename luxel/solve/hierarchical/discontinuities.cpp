#include "luxel/solve/hierarchical/discontinuities.h"

#include <algorithm>
#include <cmath>

#include "luxel/scene/light_kinds.h"
#include "luxel/solve/hierarchical/contacts.h"
#include "luxel/viewfactor/point_form_factor.h"

namespace luxel::hierarchical {
namespace {

/// Shorter pieces than this part of the receiver's size are no lines.
constexpr double kDiscontinuitiesShort = 1e-5;
/// Points of a line from which its source is looked for. Their number is the resolution at which a
/// line that is hidden in part is found at all; each costs two shadow rays.
constexpr int kLooks = 4;
/// A punctual light makes light jump. Its form factor counts as if all of it appeared within
/// this part of the receiver's size, so that such lines rank first and their weights stay finite.
constexpr double kJump = 1e-4;
/// Light of a source is looked for at the receiver's middle and this far of the way to its corners:
/// near a corner, where a source beside it is strongest, and not at it, where the closed form of a
/// source that touches the point has no limit.
constexpr double kAlmostCorner = 0.95;
/// Suns stand this many diameters of the scene away: their rays differ by 1e-4 rad across it.
constexpr double kSunDistance = 1e4;
/// Lines over which light changes by less than this part of its mean, over the length of the
/// scene's mean face, are left out (Ranking::slope). It is twice the usual eps of links
/// (solve.cpp). Larger, borders of shadows are blurred over
/// elements; smaller, triangles follow lines that refinement would not have looked at.
constexpr double kLeastSlope = 0.02;
/// Lines of less than this part of the brightest face's radiosity are left out (Ranking::nearness):
/// those of a source of that face's radiosity whose blocker is 20 times nearer to it than to the
/// receiver. [Hardt96, chapter 7] gives 100 for its scene, a limit that follows no light.
constexpr double kLeastNearness = 0.05;

/// One face, and the data to look for the discontinuities on it.
struct View {
  const Solution& s;
  const trace::RayTracer& tracer;
  Ranking ranking;
  uint32_t receiver = 0;
  const Face& face;
  double size_m = 0;
  std::vector<Discontinuity>& out;

  double height(DVec3 p) const { return face.plane.height(p); }
};

/// The largest radiosity of a face.
float most_of(const Solution& s, uint32_t face) {
  float most = 0;
  for (uint32_t r = s.tree.first_root[face]; r < s.tree.first_root[face + 1]; ++r)
    most = std::max(most, s.light.elements[r].most);
  return most;
}
/// The mean radiosity of a face, its largest component [W/m^2].
float radiosity_of(const Solution& s, uint32_t face) {
  double sum = 0, area = 0;
  for (uint32_t r = s.tree.first_root[face]; r < s.tree.first_root[face + 1]; ++r) {
    sum += s.tree.elements[r].area_m2 * double(max_component(s.light.elements[r].radiosity));
    area += s.tree.elements[r].area_m2;
  }
  return area > 0 ? float(sum / area) : 0;
}

/// Where the ray from a point over another one meets the plane: the first is higher.
DVec3 shadow_of(const View& v, DVec3 blocker, DVec3 from) {
  const double hb = v.height(blocker), hs = v.height(from);
  return blocker + (blocker - from) * (hb / (hs - hb));
}

/// One place of a discontinuity: of the source, of the blocker, and on the receiver.
struct Ray3 {
  DVec3 source, blocker, receiver;
};

/// The part of a source of this size that appears per metre that one goes across a line. The strip
/// of the source that appears is d_sb / d_br times as wide as the way gone, and no longer than the
/// source.
double geometric_factor(const View& v, const Ray3& ray, DVec3 source_normal, double source_size_m) {
  const double sb = length(ray.source - ray.blocker);
  const double br = std::max(length(ray.blocker - ray.receiver), 1e-6 * v.size_m);
  if (v.ranking == Ranking::nearness) return sb / br;
  const double fastest = 1 / (kJump * v.size_m);
  if (source_normal == DVec3{}) return fastest;
  const DVec3 d = ray.source - ray.receiver;
  const double distance = std::max(length(d), 1e-9);
  const double cos_r = std::max(0.0, dot(d, v.face.plane.normal) / distance);
  const double cos_s = std::abs(dot(d, source_normal)) / distance;
  const double whole = std::min(
      1.0, cos_r * cos_s * source_size_m * source_size_m / (kPiDouble * distance * distance));
  return whole * std::min(1 / source_size_m * sb / br, fastest);
}

/// A ray runs free but for the blocker's edge in its middle.
bool runs_free(const View& v, const Ray3& ray) {
  const auto nudge = [&](DVec3 from, DVec3 to) {
    const double way = length(to - from),
                 step = std::min(1e-4 * way, 1e-4 * double(v.s.diagonal_m));
    return way > 0 ? from + (to - from) * (step / way) : from;
  };
  const DVec3 start = ray.receiver + v.face.plane.normal * (4 * v.s.blockers.slack_m);
  const std::array<std::array<DVec3, 2>, 2> pieces{
      {{nudge(start, ray.blocker), nudge(ray.blocker, start)},
       {nudge(ray.blocker, ray.source), nudge(ray.source, ray.blocker)}}};
  std::array<trace::Ray, 2> rays;
  for (size_t k = 0; k < 2; ++k)
    rays[k] = {to_float(pieces[k][0]), 0, to_float(pieces[k][1] - pieces[k][0]), 1};
  std::array<uint8_t, 2> blocked{};
  v.tracer.occluded(rays, blocked);
  return !blocked[0] && !blocked[1];
}

/// A source, and the least weight of the lines that it may cast.
struct Source {
  uint32_t number = 0;
  PolygonView corners;
  DVec3 normal;
  double size_m = 0;
  float radiosity = 0;
  double least_weight = 0;
};

/// Adds the line along which `rays` end, between two of them, where the source is seen over it.
template <class RayAt>
void add_line(const View& v, const Source& source, DiscontinuityKind kind, uint32_t blocker,
              Segment line, const RayAt& ray_at) {
  if (!clip_to(v.face.corners, v.face.plane.normal, line)) return;
  if (length(line.b - line.a) < kDiscontinuitiesShort * v.size_m) return;
  // The highest rate at which the source appears, over the line.
  double geometric = 0;
  int free = 0;
  for (int k = 0; k < kLooks; ++k) {
    const Ray3 ray = ray_at(line.a + (line.b - line.a) * ((k + 0.5) / kLooks));
    geometric = std::max(geometric, geometric_factor(v, ray, source.normal, source.size_m));
  }
  if (geometric * double(source.radiosity) < source.least_weight) return;
  // The source must be seen over the blocker from somewhere on the line.
  for (int k = 0; k < kLooks; ++k)
    free += runs_free(v, ray_at(line.a + (line.b - line.a) * ((k + 0.5) / kLooks)));
  if (free == 0) return;
  v.out.push_back({line.a, line.b, kind, source.number, blocker, geometric});
}

/// Where two lines come nearest, on the first one.
DVec3 nearest_on(DVec3 a, DVec3 b, DVec3 p, DVec3 q) {
  const DVec3 u = b - a, w = q - p, d = p - a;
  const double uu = dot(u, u), uw = dot(u, w), ww = dot(w, w);
  const double det = uu * ww - uw * uw;
  if (!(det > 1e-18 * uu * ww)) return a;
  const double t = (dot(d, u) * ww - dot(d, w) * uw) / det;
  return a + u * std::clamp(t, 0.0, 1.0);
}

/// A vertex of the source, an edge of the blocker.
void add_ve(const View& v, const Source& source, uint32_t blocker, DVec3 vertex, Segment edge) {
  const double hv = v.height(vertex), slack = v.s.blockers.slack_m;
  if (hv <= slack) return;
  if (!clip_linear(edge, v.height(edge.a), v.height(edge.b), slack, hv * (1 - 1e-6))) return;
  if (source.normal != DVec3{}) {
    const double offset = dot(source.normal, vertex);
    if (!clip_linear(edge, dot(source.normal, edge.a) - offset, dot(source.normal, edge.b) - offset,
                     1e-9, INFINITY))
      return;
  }
  const Segment line{shadow_of(v, edge.a, vertex), shadow_of(v, edge.b, vertex)};
  add_line(v, source, DiscontinuityKind::ve, blocker, line, [&](DVec3 p) {
    return Ray3{vertex, nearest_on(edge.a, edge.b, p, vertex), p};
  });
}

/// An edge of the source, a vertex of the blocker.
void add_ev(const View& v, const Source& source, uint32_t blocker, Segment edge, DVec3 vertex) {
  const double hb = v.height(vertex), slack = v.s.blockers.slack_m;
  if (hb <= slack || dot(source.normal, vertex - edge.a) <= slack) return;
  if (!clip_linear(edge, v.height(edge.a), v.height(edge.b), hb * (1 + 1e-6) + slack, INFINITY))
    return;
  const Segment line{shadow_of(v, vertex, edge.a), shadow_of(v, vertex, edge.b)};
  add_line(v, source, DiscontinuityKind::ev, blocker, line, [&](DVec3 p) {
    return Ray3{nearest_on(edge.a, edge.b, p, vertex), vertex, p};
  });
}

void add_shadows(const View& v, const Source& source, std::span<const uint32_t> blockers) {
  for (const uint32_t b : blockers) {
    const Polygon& polygon = v.s.faces.faces[b].corners;
    for (size_t k = 0; k < polygon.size(); ++k) {
      const Segment edge{polygon[k], polygon[(k + 1) % polygon.size()]};
      for (const DVec3& vertex : source.corners) add_ve(v, source, b, vertex, edge);
      for (size_t j = 0; j < source.corners.size() && source.corners.size() > 1; ++j)
        add_ev(v, source, b, {source.corners[j], source.corners[(j + 1) % source.corners.size()]},
               polygon[k]);
    }
  }
}

void add_horizon(const View& v, const Source& source, const Face& face) {
  double low = INFINITY, high = -INFINITY;
  for (const DVec3& p : v.face.corners) {
    low = std::min(low, face.plane.height(p)), high = std::max(high, face.plane.height(p));
  }
  if (low > -v.s.blockers.slack_m || high < v.s.blockers.slack_m) return;
  Segment line;
  const DVec3 middle = viewfactor::mean_corner(v.face.corners);
  if (!meet(v.face.plane, face.plane, middle, 4 * v.size_m, line)) return;
  if (!clip_to(v.face.corners, v.face.plane.normal, line)) return;
  if (length(line.b - line.a) < kDiscontinuitiesShort * v.size_m) return;
  const DVec3 to = viewfactor::mean_corner(face.corners);
  const double distance = std::max(length(to - (line.a + line.b) * 0.5), 1e-9);
  const double geometric =
      v.ranking == Ranking::nearness ? 1 : std::min(1.0, source.size_m / distance) / distance;
  if (geometric * double(source.radiosity) < source.least_weight) return;
  v.out.push_back({line.a, line.b, DiscontinuityKind::horizon, source.number, kNone, geometric});
}

/// Edges of other faces that lie in the receiver, and lines where others pass through it.
void add_contacts(const View& v, std::span<const uint32_t> others) {
  for (const uint32_t other : others) {
    const auto line = contact_of(v.s.faces, v.receiver, other, v.s.blockers.slack_m);
    if (!line || length(line->b - line->a) < kDiscontinuitiesShort * v.size_m) continue;
    v.out.push_back({line->a, line->b, DiscontinuityKind::contact, kNone, other, INFINITY});
  }
}

/// The most that a source brings to points of the receiver, nothing in between [W/m^2].
double light_of(const View& v, PolygonView source, float radiosity) {
  double most = 0;
  const DVec3 middle = viewfactor::mean_corner(v.face.corners);
  const auto look = [&](DVec3 p) {
    most = std::max(most, viewfactor::point_to_polygon(p, v.face.plane.normal, source));
  };
  look(middle);
  for (const DVec3& corner : v.face.corners) look(middle + (corner - middle) * kAlmostCorner);
  return most * double(radiosity);
}

void add_faces(const View& v, double least_weight, double least_light) {
  std::vector<uint32_t> blockers;
  for (uint32_t f = 0; f < v.s.faces.size(); ++f) {
    if (f == v.receiver) continue;
    // The part of the face above the receiver, if it brings light enough.
    const Face& face = v.s.faces.faces[f];
    const float radiosity = radiosity_of(v.s, f);
    if (double(most_of(v.s, f)) < least_light) continue;
    const Polygon above = viewfactor::clip_above(face.corners, v.face.plane, v.s.blockers.slack_m);
    if (above.empty()) continue;
    const Source source{.number = f,
                        .corners = above,
                        .normal = face.plane.normal,
                        .size_m = std::sqrt(viewfactor::area_m2(face.corners)),
                        .radiosity = radiosity,
                        .least_weight = least_weight};
    if (light_of(v, above, radiosity) < least_light) continue;
    // Its horizon, and the borders of what other faces hide of it.
    add_horizon(v, source, face);
    find_between(v.s.blockers, v.face.corners, above, blockers);
    std::erase(blockers, f), std::erase(blockers, v.receiver);
    add_shadows(v, source, blockers);
  }
}

void add_punctual_lights(const View& v, const scene::Scene& scene, double least_weight,
                         double least_light) {
  for (uint32_t k = 0; k < scene.lights.size(); ++k) {
    const scene::PunctualLight& light = scene.lights[k];
    const DVec3 middle = viewfactor::mean_corner(v.face.corners);
    const float e =
        max_component(light::incidence_at(light, scene.profiles, to_float(middle)).irradiance);
    DVec3 place = to_double(light.position);
    if (!scene::has_position(light.kind))
      place = middle - to_double(light.direction) * (kSunDistance * double(v.s.diagonal_m));
    if (v.height(place) <= 0 || double(e) < least_light) continue;
    const std::array<DVec3, 1> corner{place};
    const Source source{.number = kPunctualSource + k,
                        .corners = corner,
                        .normal = {},
                        .size_m = 0,
                        .radiosity = e,
                        .least_weight = least_weight};
    std::vector<uint32_t> blockers;
    Polygon cone = v.face.corners;
    find_before(v.s.blockers, place, cone, blockers);
    std::erase(blockers, v.receiver);
    add_shadows(v, source, blockers);
  }
}

}  // namespace

DiscontinuityLimits limits_of(const Solution& s, const DiscontinuityParams& params) {
  const double mean = double(max_component(totals_of(s).irradiance));
  DiscontinuityLimits out{0, params.least_light * mean};
  if (params.least_weight) {
    out.weight = *params.least_weight;
  } else if (params.ranking == Ranking::slope) {
    out.weight = kLeastSlope * mean / std::sqrt(s.unit_area_m2);
  } else {
    float most = 0;
    for (uint32_t f = 0; f < s.faces.size(); ++f) most = std::max(most, most_of(s, f));
    out.weight = kLeastNearness * double(most);
  }
  return out;
}

double weight_of(const Discontinuity& d, const Solution& s, const scene::Scene& scene) {
  if (d.kind == DiscontinuityKind::contact) return INFINITY;
  if (d.source >= kPunctualSource)
    return d.geometric *
           double(max_component(light::incidence_at(scene.lights[d.source - kPunctualSource],
                                                    scene.profiles, to_float(d.a))
                                    .irradiance));
  return d.geometric * double(radiosity_of(s, d.source));
}

std::vector<Discontinuity> find_discontinuities(const Solution& s, const scene::Scene& scene,
                                                const trace::RayTracer& tracer, uint32_t receiver,
                                                Ranking ranking,
                                                const DiscontinuityLimits& limits) {
  std::vector<Discontinuity> out;
  const Face& face = s.faces.faces[receiver];
  if (face.curved) return out;
  const View v{s,  tracer, ranking, receiver, face, std::sqrt(viewfactor::area_m2(face.corners)),
               out};
  add_faces(v, limits.weight, limits.light);
  add_punctual_lights(v, scene, limits.weight, limits.light);
  std::vector<uint32_t> near;
  find_near(s.blockers, face.corners, near);
  std::erase(near, receiver);
  add_contacts(v, near);
  return out;
}

}  // namespace luxel::hierarchical
