#include "luxel/solve/hierarchical/irradiance.h"

#include <algorithm>

#include "luxel/base/parallel.h"
#include "luxel/light/direct_light.h"
#include "luxel/light/punctual_tree.h"
#include "luxel/solve/hierarchical/gathering.h"
#include "luxel/solve/hierarchical/surface.h"

namespace luxel::hierarchical {
namespace {

/// Beyond so many faces the background is looked for by rays instead of as what no face hides.
constexpr size_t kMostFacesBeforeSky = 256;
/// Rays towards the sky are so many over the tolerance: E comes in steps of about 1 / rays of the
/// sky's, half of which is the error. No fewer than keep the steps below what interpolants may be
/// off by (1e-3 of the light), and no more than a point may cost.
constexpr double kSkyRays = 0.5;
constexpr double kLeastSkyRays = 1024, kMostSkyRays = 8192;

double limit_of(const Solution& s, const PointParams& params) {
  return params.tolerance * double(max_component(totals_of(s).irradiance));
}

bool is_sharp(const scene::PunctualLight& light) { return light.angular_radius_rad == 0; }

/// E of punctual lights.
Result<std::vector<Rgb>> from_punctual_lights(const scene::Scene& scene,
                                              const trace::RayTracer& tracer,
                                              const light::Lights& lights,
                                              std::span<const Receiver> receivers,
                                              Progress& progress) {
  if (lights.punctual.empty() && lights.around.bright_texels.empty())
    return std::vector<Rgb>(receivers.size());
  transport::Elements points;
  for (const Receiver& r : receivers) {
    points.position.push_back(r.start());
    points.normal.push_back(to_float(r.normal));
    points.geometric_normal.push_back(to_float(r.geometric_normal));
    points.reflectance.push_back({});
  }
  LUXEL_TRY(light::DirectLight direct,
            light::direct_light(scene, points, lights, tracer,
                                {.samples = 256, .same_points = true}, progress));
  return std::move(direct.irradiance);
}

}  // namespace

Result<std::vector<Rgb>> irradiance_at(const Solution& s, const scene::Scene& scene,
                                       const trace::RayTracer& tracer,
                                       std::span<const Receiver> receivers,
                                       const PointParams& params, Progress& progress) {
  // Punctual lights.
  UnlinkedLights unlinked = s.unlinked;
  if (!params.sharp_lights) {
    std::erase_if(unlinked.lights.punctual, is_sharp);
    light::build_punctual_tree(unlinked.lights);
  }
  LUXEL_TRY(std::vector<Rgb> out,
            from_punctual_lights(scene, tracer, unlinked.lights, receivers, progress));
  // A sky of one radiance is what no face hides; one that varies, or shines through holes, is
  // looked at.
  const bool count_all = unlinked.has_sky && scene.environment.empty() &&
                         s.faces.size() <= kMostFacesBeforeSky &&
                         std::ranges::none_of(s.faces.faces, &Face::has_holes);
  const double whole_sky = kPiDouble * double(max_component(scene.background));
  // Faces, and the sky past them.
  const GatheringParams gathered{.limit = limit_of(s, params), .sky = count_all ? whole_sky : 0};
  const RaySources sources = ray_sources(s);
  const auto sky_rays =
      uint32_t(std::clamp(kSkyRays / params.tolerance, kLeastSkyRays, kMostSkyRays));
  const SkyScene sky{scene, unlinked.lights.around, tracer};
  const auto sky_at = [&](const Receiver& r, SkyRays& rays) {
    return soft_sky_at(sky, {r.start(), to_float(r.normal), to_float(r.geometric_normal)}, sky_rays,
                       rays);
  };
  // Each receiver gathers from all faces.
  progress.begin("irradiance", receivers.size());
  parallel_for(receivers.size(), 32, [&](size_t begin, size_t end) {
    Gathering gathering(s, tracer, sources, gathered);
    SkyRays rays;
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      out[i] += gathering.from_faces(receivers[i], nullptr);
      if (!unlinked.has_sky) continue;
      out[i] += count_all ? scene.background * (kPi * float(std::max(0.0, 1 - gathering.covered())))
                          : sky_at(receivers[i], rays);
    }
    progress.advance(end - begin);
  });
  LUXEL_TRY_STATUS(stopped(progress));
  return out;
}

Result<std::vector<Rgb>> sharp_irradiance_at(const scene::Scene& scene,
                                             const trace::RayTracer& tracer,
                                             std::span<const Receiver> receivers,
                                             Progress& progress) {
  light::Lights lights;
  lights.punctual = scene.lights, lights.profiles = scene.profiles;
  std::erase_if(lights.punctual, [](const auto& light) { return !is_sharp(light); });
  light::build_punctual_tree(lights);
  return from_punctual_lights(scene, tracer, lights, receivers, progress);
}

std::vector<Seen> sources_at(const Solution& s, const trace::RayTracer& tracer,
                             const Receiver& receiver, const PointParams& params) {
  std::vector<Seen> parts, out;
  Gathering(s, tracer, ray_sources(s), {.limit = limit_of(s, params)}).from_faces(receiver, &parts);
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Seen& a, const Seen& b) { return a.face < b.face; });
  for (const Seen& part : parts) {
    if (out.empty() || out.back().face != part.face)
      out.push_back({.face = part.face, .irradiance = {}});
    out.back().visible += part.visible, out.back().whole += part.whole;
    out.back().irradiance += part.irradiance;
  }
  std::stable_sort(out.begin(), out.end(), [](const Seen& a, const Seen& b) {
    return luminance(a.irradiance) > luminance(b.irradiance);
  });
  return out;
}

Backprojection backproject(const Solution& s, const Receiver& receiver, uint32_t face) {
  Backprojection out;
  const Face& f = s.faces.faces[face];
  const Plane horizon{receiver.geometric_normal, dot(receiver.geometric_normal, receiver.position)};
  out.source = viewfactor::clip_above(f.corners, horizon, s.blockers.slack_m * 1e-3);
  if (out.source.empty()) return out;
  if (f.plane.height(receiver.position) < 0) std::reverse(out.source.begin(), out.source.end());
  std::vector<uint32_t> blockers;
  find_before(s.blockers, receiver.position, out.source, blockers);
  std::erase(blockers, face), std::erase(blockers, receiver.face);
  std::vector<uint8_t> casts(s.blockers.all.size());
  viewfactor::VisibilityScratch scratch;
  viewfactor::visible_point_factor(receiver.position, receiver.normal, out.source,
                                   {s.blockers.all, blockers}, s.blockers.slack_m * 1e-3, casts,
                                   scratch);
  for (size_t k = 0; k < scratch.visible.size(); ++k) {
    out.visible.emplace_back();
    for (const DVec3& p : scratch.visible[k]) out.visible.back().push_back(p + receiver.position);
  }
  return out;
}

Receiver receiver_at(const Solution& s, const scene::Scene& scene, const trace::RayTracer& tracer,
                     uint32_t face, DVec3 place) {
  const Face& f = s.faces.faces[face];
  if (!f.curved) return {place, f.plane.normal, f.plane.normal, face, f.size_m};
  const transport::SmoothPoint p =
      transport::smooth_point(scene, surface_point(scene, s.faces, tracer, face, place));
  return {to_double(p.position), to_double(p.normal), to_double(p.geometric_normal), face,
          f.size_m};
}

}  // namespace luxel::hierarchical
