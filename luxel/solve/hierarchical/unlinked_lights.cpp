#include "luxel/solve/hierarchical/unlinked_lights.h"

#include <algorithm>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/light/direct_light.h"
#include "luxel/light/punctual_tree.h"
#include "luxel/scene/off_surface.h"

namespace luxel::hierarchical {
namespace {

/// Rays per point towards the sky. A border crosses about sqrt(256) cells of their grid, so E comes
/// in steps of some 1/256 of the sky's.
constexpr uint32_t kUnlinkedLightsSkyRays = 256;
/// Light is not known better than what so many rays bring: differences below that are none. A
/// border of 16 cells errs by about sqrt(16) = 4 rays. With fewer, leaves would be divided for
/// these steps.
constexpr float kUnsureRays = 4;
/// Points of a leaf of the unit's area at which lights are looked for, at least, so that no patch
/// of sun of an eighth of its length is missed. Smaller leaves have fewer, by their area.
constexpr double kPoints = 64;
/// Leaves that were not looked at yet have this.
constexpr float kNotLit = -1;

/// Where lights are looked for on a leaf: at Gauss's points, which are corners of a smaller copy of
/// it, and on a grid, as fine as the leaf is large.
struct Probe {
  uint32_t corners = 4;
  std::vector<std::array<double, 2>> at;  ///< s and t of linear_at

  /// From the middle to Gauss's points: so far of the way to the corners.
  double inside() const { return corners == 4 ? 0.57735027 : 0.5; }
};

Probe probe_of(const Element& e, double unit_area_m2) {
  Probe out{e.corners, {}};
  // Gauss's points.
  const double h = out.inside() / (e.corners == 4 ? 2 : 3);
  if (e.corners == 4)
    out.at = {{0.5 - h, 0.5 - h}, {0.5 + h, 0.5 - h}, {0.5 + h, 0.5 + h}, {0.5 - h, 0.5 + h}};
  else
    out.at = {
        {1 / 3.0 - h, 1 / 3.0 - h}, {1 / 3.0 + 2 * h, 1 / 3.0 - h}, {1 / 3.0 - h, 1 / 3.0 + 2 * h}};
  // A grid, as fine as the leaf is large.
  const double points = std::min(1.0, e.area_m2 / unit_area_m2) * kPoints;
  // An odd number of points a side, so that the middle is one of them.
  const int n = 1 + 2 * int(std::sqrt(points) / 2);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double s = (i + 0.5) / n, t = (j + 0.5) / n;
      if (e.corners == 4)
        out.at.push_back({s, t});
      else if (n == 1)
        out.at.push_back({1 / 3.0, 1 / 3.0});
      else
        out.at.push_back({s, t * (1 - s)});
    }
  return out;
}

/// The function through Gauss's points, given by its corners, bent as far up as it would be
/// negative; and how far it is off elsewhere.
struct SkyFit {
  std::array<Rgb, 4> corner{};
  float error = 0;
};
SkyFit fit_of(const Probe& probe, std::span<const Rgb> light) {
  // Mean, and twist of a bilinear function.
  SkyFit out;
  const uint32_t n = probe.corners;
  Rgb mean{}, twist{};
  for (uint32_t k = 0; k < n; ++k) mean += light[k] / float(n);
  if (n == 4) twist = (light[0] - light[1] + light[2] - light[3]) * 0.25f;
  // From Gauss's points out to the corners, no further down than to 0.
  const auto inside = float(probe.inside());
  float shrink = 1;  // of what differs from the mean
  for (uint32_t k = 0; k < n; ++k) {
    const Rgb bent = twist * (k % 2 == 0 ? 1.0f : -1.0f);
    out.corner[k] = (light[k] - mean - bent) / inside + bent / (inside * inside);
    for (const auto c : {&Rgb::x, &Rgb::y, &Rgb::z})
      if (mean.*c + out.corner[k].*c < 0) shrink = std::min(shrink, -mean.*c / out.corner[k].*c);
  }
  for (uint32_t k = 0; k < n; ++k) out.corner[k] = mean + out.corner[k] * shrink;
  // The largest deviation of that from the light at all points.
  for (size_t i = 0; i < probe.at.size(); ++i) {
    const Rgb d = linear_at(out.corner, n, float(probe.at[i][0]), float(probe.at[i][1])) - light[i];
    out.error = std::max({out.error, max_component(d), max_component(-d)});
  }
  return out;
}

void add_points(const Element& e, const Faces& faces, const Probe& probe,
                transport::Elements& out) {
  const Face& face = faces.faces[e.face];
  const Vec3 normal = to_float(face.plane.normal);
  for (const auto& [s, t] : probe.at) {
    const Vec3 place = to_float(linear_at(e.corner, e.corners, s, t));
    out.position.push_back(scene::off_surface(place, normal, face.size_m));
    out.normal.push_back(normal), out.geometric_normal.push_back(normal);
    out.reflectance.push_back({});
  }
}

void turn_rays(const SkyScene& sky, const light::Receiver& point, uint32_t count, SkyRays& rays) {
  rays.normal = point.normal, rays.geometric_normal = point.geometric_normal, rays.count = count;
  rays.direction.clear();
  const Frame frame = frame_around(point.normal);
  for (uint32_t k = 0; k < count; ++k) {
    const Vec3 d = frame.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, 5)));
    if (dot(d, point.geometric_normal) > 0) rays.direction.push_back(d);
  }
  light::soft_radiance(sky.scene, sky.around, rays.direction, rays.radiance);
}

/// E of the soft sky at each point.
std::vector<Rgb> sky_light(const scene::Scene& scene, const Exchange& x,
                           const UnlinkedLights& unlinked, const transport::Elements& points) {
  std::vector<Rgb> out(points.size());
  if (!unlinked.has_sky) return out;
  const SkyScene sky{scene, unlinked.lights.around, x.tracer};
  parallel_for(points.size(), 64, [&](size_t begin, size_t end) {
    SkyRays rays;
    for (size_t i = begin; i < end; ++i)
      out[i] = soft_sky_at(sky, {points.position[i], points.normal[i], points.normal[i]},
                           kUnlinkedLightsSkyRays, rays);
  });
  return out;
}

}  // namespace

Rgb soft_sky_at(const SkyScene& sky, const light::Receiver& point, uint32_t count, SkyRays& rays) {
  if (rays.count != count || rays.normal != point.normal ||
      rays.geometric_normal != point.geometric_normal)
    turn_rays(sky, point, count, rays);
  rays.rays.clear();
  for (const Vec3 d : rays.direction) rays.rays.push_back({point.position, 0, d, INFINITY});
  rays.blocked.resize(rays.rays.size());
  sky.tracer.occluded(rays.rays, rays.blocked);
  // Summed in double: a sky of one radiance gives its share of the rays, whatever their order.
  double r = 0, g = 0, b = 0;
  for (size_t k = 0; k < rays.blocked.size(); ++k) {
    if (rays.blocked[k]) continue;
    const Rgb l = rays.radiance[k];
    r += double(l.x), g += double(l.y), b += double(l.z);
  }
  const double share = kPiDouble / double(count);
  return {float(r * share), float(g * share), float(b * share)};
}

float brightest_sky(const scene::Scene& scene, const light::Surroundings& around) {
  float most = max_component(around.background);
  if (scene.environment.empty()) return most;
  float brightest = 0;
  for (const Rgb& l : scene.environment.radiance) {
    const float y = luminance(l);
    brightest = std::max(brightest, max_component(l) * (y > around.limit ? around.limit / y : 1));
  }
  return most + brightest;
}

UnlinkedLights unlinked_lights_of(const scene::Scene& scene) {
  UnlinkedLights out;
  out.lights.punctual = scene.lights, out.lights.profiles = scene.profiles;
  light::build_punctual_tree(out.lights);
  out.lights.around = light::surroundings_of(scene);
  out.has_sky = max_component(scene.background) > 0 || !scene.environment.empty();
  return out;
}

Status light_leaves(Refined& state, const Exchange& x, const UnlinkedLights& unlinked,
                    const RefineParams& params, std::vector<float>& off, Progress& progress) {
  if (!unlinked.any()) return {};
  const float unsure = unlinked.has_sky ? brightest_sky(state.scene, unlinked.lights.around) * kPi *
                                              (kUnsureRays / kUnlinkedLightsSkyRays)
                                        : 0.0f;
  for (;;) {
    // Points of all leaves that have no light yet.
    off.resize(state.tree.elements.size(), kNotLit);
    std::vector<size_t> leaves;
    std::vector<Probe> probes;
    transport::Elements points;
    for (size_t e = 0; e < off.size(); ++e) {
      if (off[e] != kNotLit || !state.tree.elements[e].is_leaf()) continue;
      leaves.push_back(e);
      probes.push_back(probe_of(state.tree.elements[e], x.unit_area_m2));
      add_points(state.tree.elements[e], x.faces, probes.back(), points);
    }
    // Light there, of punctual lights and of the sky: a linear function per leaf.
    LUXEL_TRY(light::DirectLight direct,
              light::direct_light(state.scene, points, unlinked.lights, x.tracer,
                                  {.samples = 64, .same_points = true}, progress));
    const std::vector<Rgb> sky = sky_light(state.scene, x, unlinked, points);
    for (size_t i = 0; i < sky.size(); ++i) direct.irradiance[i] += sky[i];
    std::span<const Rgb> light = direct.irradiance;
    for (size_t k = 0; k < leaves.size(); ++k) {
      const SkyFit fit = fit_of(probes[k], light.first(probes[k].at.size()));
      light = light.subspan(probes[k].at.size());
      state.light.elements[leaves[k]].unlinked = fit.corner;
      off[leaves[k]] = std::max(0.0f, fit.error - unsure);
    }
    // Leaves over which it is off are divided, and their parts come next.
    const size_t elements = off.size();
    for (size_t e = 0; e < elements; ++e) {
      const double area = state.tree.elements[e].area_m2;
      if (state.tree.elements[e].is_leaf() && double(off[e]) * area / x.unit_area_m2 > params.eps &&
          area > 4 * params.min_area_m2 && state.tree.elements.size() + 4 <= params.max_elements)
        divide_element(state, x, e);
    }
    if (state.tree.elements.size() == elements) return {};
  }
}

}  // namespace luxel::hierarchical
