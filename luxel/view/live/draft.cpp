#include "luxel/view/live/draft.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/transport/irradiance_field.h"
#include "luxel/view/frame.h"

namespace luxel::view {
namespace {

/// Laying out a million triangles takes seconds.
constexpr size_t kMostTriangles = 200'000;
/// Texels along a side; the second for scenes of many charts.
constexpr int kDraftSides[] = {96, 512};
/// The draft's surface is looked for this far above and below a surface, over the scene's diagonal.
constexpr float kReach = 1e-4f;

pipeline::BakeSettings draft_settings(const pipeline::BakeSettings& of, const DraftParams& params,
                                      int side) {
  pipeline::BakeSettings out;
  out.output = of.output;
  out.resolution = side;
  out.samples = params.samples, out.direct_samples = params.direct_samples;
  out.supersample = params.supersample;
  out.bounces = of.bounces;
  out.seed = of.seed, out.threads = of.threads, out.max_memory_bytes = of.max_memory_bytes;
  return out;
}

void keep(const light::TexelScene& in, const light::LightEstimate& light, Draft& out) {
  out.scene = in.scene, out.atlas = in.atlas, out.map = in.map;
  out.irradiance.assign(light.irradiance.begin(), light.irradiance.end());
  out.direct.assign(light.direct.begin(), light.direct.end());
}

/// The light of a bake with these settings. False: it has none. Errors: those of a bake; cancelled.
Result<bool> light_draft(const scene::Scene& scene, const pipeline::BakeSettings& settings,
                         const Progress& watched, Draft& out) {
  Progress own;
  bool has_light = false;
  out.bounced.clear();
  pipeline::BakeObserver observer;
  observer.on_estimate = [&](const light::TexelScene& in, const light::LightEstimate& light) {
    if (light.is_last) keep(in, light, out);
    has_light = light.is_last;
    // Stages after the light are not needed.
    if (light.is_last || watched.cancelled()) own.request_cancel();
  };
  observer.on_bounce = [&](const light::TexelScene&, std::span<const Rgb> e) {
    out.bounced.emplace_back(e.begin(), e.end());
    return out.bounced.size() <= kMostBounces && !watched.cancelled();
  };
  const auto baked = pipeline::bake_read_scene(scene, settings, own, {}, observer);
  LUXEL_TRY_STATUS(stopped(watched));
  if (!has_light && !baked) return Failure{baked.error()};
  return has_light;
}

}  // namespace

Result<std::unique_ptr<Draft>> make_draft(const scene::Scene& scene,
                                          const pipeline::BakeSettings& settings,
                                          const DraftParams& params, const Progress& watched) {
  if (settings.solver != "gather" || settings.light != pipeline::LightPart::all ||
      scene::first_triangles(scene).back() > kMostTriangles)
    return nullptr;
  auto out = std::make_unique<Draft>();
  Result<bool> lit = false;
  for (const int side : kDraftSides) {
    if (settings.resolution && *settings.resolution <= side) break;
    lit = light_draft(scene, draft_settings(settings, params, side), watched, *out);
    if (lit || lit.error().code != ErrorCode::bad_setting) break;  // else charts do not fit
  }
  if (!lit) return Failure{lit.error()};
  if (!*lit) return nullptr;
  LUXEL_TRY(trace::RayTracer tracer, trace::RayTracer::build(out->scene));
  out->tracer.emplace(std::move(tracer));
  return out;
}

std::vector<Rgb> light_of_draft(const Draft& draft, std::span<const Rgb> of_texels,
                                std::span<const Place> places) {
  const transport::TexelField field{&draft.atlas, &draft.map, of_texels};
  Rgb mean{};
  for (const Rgb& e : of_texels) mean += e;
  mean = mean * (1 / float(std::max<size_t>(of_texels.size(), 1)));
  const float reach = kReach * scene::world_bounds(draft.scene).diagonal();
  std::vector<Rgb> out(places.size(), mean);
  parallel_for(out.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto& [position, n] = places[i];
      const trace::Hit hit =
          draft.tracer->closest_hit({position + n * reach, 0, n * -1.0f, 2 * reach});
      if (hit.found()) out[i] = transport::irradiance_at(field, hit.point());
    }
  });
  return out;
}

std::vector<Rgb> light_of_draft(const Draft& draft, std::span<const Rgb> of_texels,
                                const light::TexelScene& in) {
  std::vector<Place> places(in.elements.size());
  for (size_t i = 0; i < places.size(); ++i)
    places[i] = {in.elements.position[i], in.elements.geometric_normal[i]};
  return light_of_draft(draft, of_texels, places);
}

}  // namespace luxel::view
