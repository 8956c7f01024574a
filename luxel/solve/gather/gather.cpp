#include "luxel/solve/gather/gather.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/clock.h"
#include "luxel/base/forget_at_end.h"
#include "luxel/base/free_memory.h"
#include "luxel/solve/gather/bounce/ambient.h"
#include "luxel/solve/gather/bounce/bounce_layers.h"
#include "luxel/solve/gather/bounce/radiosity_map.h"
#include "luxel/solve/gather/budget/adaptive.h"
#include "luxel/solve/gather/partial_light.h"
#include "luxel/solve/gather/rays/ray_device.h"
#include "luxel/solve/gather/rays/tile_hits.h"
#include "luxel/solve/gather/reuse/earlier.h"
#include "luxel/solve/gather/steps.h"
#include "luxel/solve/gather/trace/trace_hits.h"
#include "luxel/transport/back_faces.h"

namespace luxel::gather {
namespace {

/// Where the error is known, the last bounces end at this part of it, beside which what is left
/// does not show; on the light of an earlier bake at this part of the light, if that is less.
constexpr double kPartOfError = 1.0 / 20, kRoughestFromEarlier = 3e-4;
constexpr uint8_t kPunctualLayer = 0, kOtherLayer = 1, kReflectedLayer = 2;

/// Layers that tell light straight from its sources apart. That which rays bring that are followed
/// on was reflected, whatever it is from.
struct SourceLayers {
  light::LightLayers straight, followed;
};
SourceLayers source_layers(const light::Lights& lights) {
  const auto all_in = [&](uint8_t punctual, uint8_t others) {
    light::LightLayers out;
    out.layers.resize(kSourceLayers);
    out.of_punctual.assign(lights.punctual.size(), punctual);
    out.of_triangle.assign(lights.triangles.size(), others);
    out.of_surroundings = others;
    return out;
  };
  return {all_in(kPunctualLayer, kOtherLayer), all_in(kReflectedLayer, kReflectedLayer)};
}

/// The tolerance of the last bounces.
float last_tolerance(const Request& in) {
  const GatherParams& params = in.params;
  double rougher = 0;
  if (in.stores.earlier)
    rougher = std::min(kPartOfError * in.stores.earlier->relative_error, kRoughestFromEarlier);
  else if (params.error_measure == ErrorMeasure::rms)
    rougher = kPartOfError * double(params.max_error);
  return std::max(params.tolerance, float(rougher));
}

/// The rays of an earlier bake. Where only what lies elsewhere changes them, they tell by how much
/// the light of then changes in a sweep, too. Errors: cancelled, disk full.
Status trace_earlier(const Request& in, Progressive& light, Progress& progress) {
  const light::TexelScene& scene = in.scene;
  EarlierRays& rays = in.stores.earlier->rays;
  // Rays tell what changes where light, reflectances and the number of samples are as they were.
  const bool tells =
      rays.same_light && !light.direct_before.empty() && in.params.bounces < 0 && !in.adds_rounds();
  if (!tells) free_memory(light.direct_before);
  RadiosityMap sent = empty_radiosity_map(tells ? scene.map.resolution : 0);
  if (tells) {
    fill_radiosity(sent, scene.map, scene.elements, light.hits, in.behind,
                   light.bounced.irradiance);
    rays.sent = &sent;
  }
  for (const std::vector<uint16_t>& target : in.stores.earlier->rounds)
    LUXEL_TRY_STATUS(trace_round(in, target, light, progress));
  rays.sent = nullptr;
  if (!tells) return {};
  // The change of a sweep: that of the mean over rays, and that of the direct light.
  light.first_change = std::move(light.hits.change);
  for (size_t i = 0; i < light.first_change.size(); ++i)
    light.first_change[i] = light.first_change[i] * (1 / float(light.hits.samples[i])) +
                            light.direct.irradiance[i] - light.direct_before[i];
  free_memory(light.direct_before);
  return {};
}

/// The rays that every element gets. Errors: cancelled, disk full.
Status trace_first(const Request& in, Progressive& light, Progress& progress) {
  const size_t n = in.scene.elements.size();
  const int all = in.params.samples;
  if (in.stores.earlier) return trace_earlier(in, light, progress);
  const std::vector<uint16_t> target(n, uint16_t(all));
  if (!in.observer.on_estimate) return trace_round(in, target, light, progress);
  std::vector<Rgb> guess = in.observer.guess
                               ? in.observer.guess(light.direct.irradiance)
                               : with_ambient(in.scene.elements, light.direct.irradiance);
  in.observer.on_estimate({.irradiance = guess, .direct = light.direct.irradiance, .share = 0});
  TileQueue queue(tile_count(light.hits));
  PartialLight partial(in, light, std::move(guess), queue);
  const TileWatch watch{&queue,
                        [&](size_t first, const HitTile& hits) { partial.take(first, hits); }};
  return trace_round(in, target, light, progress, &watch);
}

/// Frees the light that rays brought without the map. The counts of rays stay.
void drop_light(TracedHits& hits) {
  free_memory(hits.sky), free_memory(hits.sky_by_layer);
  free_memory(hits.sky_luminance2), free_memory(hits.sky_first_less_second);
}

/// The light of source_layers().
SourceLight source_light(Progressive& light) {
  const std::vector<Rgb> sources = layer_sources(light.hits, std::move(light.direct.by_layer));
  SourceLight out;
  for (size_t i = 0; i < sources.size(); i += kSourceLayers) {
    out.punctual.push_back(sources[i + kPunctualLayer]);
    out.others.push_back(sources[i + kOtherLayer]);
  }
  return out;
}

/// All bounces, those of layers too, and how well their light is known. Positions and normals of
/// elements may be gone.
Status bounce_last(const Request& in, Progressive& light, Gather& out, Progress& progress) {
  LUXEL_TRY_STATUS(bounce_round(in, last_tolerance(in), light, progress));
  if (in.params.tells_direct) {
    out.sources = source_light(light);
  } else if (in.layers) {
    LayeredLight layered{.source = layer_sources(light.hits, std::move(light.direct.by_layer)),
                         .whole = light.bounced.irradiance};
    LUXEL_TRY(
        LayersBounced layers,
        bounce_layers(in.scene.map, in.scene.elements, light.hits, in.behind, std::move(layered),
                      {in.params.bounces, spare_bytes(in.stores, light.hits)}, progress));
    out.layers = std::move(layers.irradiance), out.layers_shared_out = layers.shared_out;
  }
  if (in.observer.on_bounce)
    LUXEL_TRY_STATUS(bounce_by_bounce(in.scene.map, in.scene.elements, light.hits,
                                      light.direct.irradiance, in.behind, in.params.bounces,
                                      in.observer.on_bounce, progress));
  out.hit_bytes_in_file = light.hits.bytes_in_file();
  light.hits.rounds.clear();
  light.hits.device = nullptr;
  if (in.params.tells_answers) {
    LUXEL_TRY(out.answers, answers_of(in, light, out.enclosed, progress));
  }
  LUXEL_TRY_STATUS(judge(in, light, progress));
  drop_light(light.hits);
  show(in.observer, light, true);
  return {};
}

/// Errors (ErrorCode::parts_missing): parts are left to others.
Status know_all_parts(const Request& in) {
  if (!has_left_parts(in)) return {};
  return fail(ErrorCode::parts_missing, "{} parts are left to others",
              in.stores.parts->parts_left());
}

/// Rays per element: of those that follow a guide there are more than samples.
std::vector<uint16_t> rays_of(const TracedHits& hits) {
  std::vector<uint16_t> out = hits.samples;
  for (size_t i = 0; i < out.size(); ++i)
    if (is_guided(hits, i))
      out[i] = uint16_t(
          std::min(65535.0f, std::round(float(hits.samples[i]) * rays_per_sample(hits, i))));
  return out;
}

/// Where some elements follow a guide, an element without one may have neighbours of little noise,
/// and two bright rays, one in each half, so that it seems to have little itself. Its rays taken as
/// independent tell: it gets the larger of both variances.
void raise_beside_guided(const TracedHits& hits, std::span<const float> pooled,
                         std::span<float> split) {
  for (size_t i = 0; i < split.size(); ++i)
    if (!is_guided(hits, i)) split[i] = std::max(split[i], pooled[i]);
}

/// Moves what the caller gets out of what is known in the end.
void take_result(Progressive&& light, Gather& out) {
  out.relative_error = light.errors.expected.rms();
  out.relative_noise = std::sqrt(light.errors.expected.noise);
  out.relative_unseen = light.errors.expected.rms_of_gathered_light();
  if (!light.hits.guide.of_element.empty())
    raise_beside_guided(light.hits, variances_of(light.errors.gathered, light.bounced.irradiance),
                        light.bounced.split_variance);
  out.irradiance = std::move(light.bounced.irradiance);
  out.direct = std::move(light.direct.irradiance);
  out.direct_variance = std::move(light.direct.variance);
  out.indirect_variance = std::move(light.bounced.split_variance);
  out.pooled_variance = std::move(light.errors.noise_variance);
  out.error_p95 = light.errors.p95, out.noise_p95 = light.errors.noise_p95;
  out.errors = std::move(light.errors.all);
  out.gathered_errors = std::move(light.errors.gathered);
  out.met_back = std::move(light.hits.met_back);
  out.samples = rays_of(light.hits);
  out.rays = light.direct.rays + light.hits.rays, out.rays_kept = light.hits.rays_kept;
  out.supersampled = light.averaged;
  out.sweeps = light.bounced.sweeps;
}

}  // namespace

Result<Gather> gather(const light::TexelScene& scene, const light::LightLayers* layers,
                      const GatherParams& params, const GatherStores& stores,
                      const GatherObserver& observer, Progress& progress) {
  LUXEL_CHECK(!params.tells_direct || layers == nullptr);
  LUXEL_CHECK(!params.tells_answers || params.bounces < 0);
  LUXEL_CHECK(!stores.team || !(stores.device || stores.keep || stores.earlier ||
                                (stores.parts && stores.parts->shares()) || observer.on_estimate));
  const auto start = Clock::now();
  LUXEL_TRY(const transport::OwnSides sides,
            transport::find_own_sides(scene.scene, scene.atlas, scene.map, scene.tracer,
                                      stores.team, progress));
  light::TexelScene lit = scene;
  Request in{lit, layers, params, stores, observer, sides};
  const SourceLayers sources = params.tells_direct ? source_layers(scene.lights) : SourceLayers{};
  if (params.tells_direct) in.layers = &sources.straight, in.followed_layers = &sources.followed;
  Progressive light;
  const ForgetAtEnd use{scene.elements.size() > 0 ? stores.device : nullptr};
  if (use.device) {
    LUXEL_TRY_STATUS(use.device->begin(trace_scene(scene, &sides)));
    LUXEL_TRY(lit.light_device, use.device->light_device(trace_scene(scene, &sides)));
  }
  // 1. Light straight from the lights, with shadow rays.
  LUXEL_TRY_STATUS(begin_direct(in, light, progress));
  // 2. The rays that every element gets, and what they hit.
  in.behind = places_behind(sides, scene.elements);
  const auto& memory = scene.elements.reflectance.get_allocator().memory;
  light.hits = no_hits(scene.elements.size(), in.layer_count(), memory);
  if (memory) LUXEL_TRY_STATUS(memory->trouble());
  if (stores.earlier) light.bounced.irradiance = std::move(stores.earlier->irradiance);
  LUXEL_TRY_STATUS(trace_first(in, light, progress));
  LUXEL_TRY_STATUS(know_all_parts(in));
  LUXEL_TRY_STATUS(balance_direct(in, light, progress));
  LUXEL_TRY_STATUS(know_all_parts(in));
  LUXEL_TRY_STATUS(add_where_grainy(in, light, progress));
  LUXEL_TRY_STATUS(know_all_parts(in));
  LUXEL_TRY_STATUS(choose_places(in, light, progress));
  // 3. Rounds of more rays where the estimated error is too large.
  for (bool more = in.adds_rounds(); more;) {
    LUXEL_TRY_STATUS(estimate_round(in, light, progress));
    LUXEL_TRY(more, next_round(in, params.seconds - seconds_since(start), light, progress));
    LUXEL_TRY_STATUS(know_all_parts(in));
  }
  if (stores.parts && stores.parts->shares())
    return fail(ErrorCode::parts_missing, "all rays are known; the rest is not shared out");
  // 4. Which elements lie inside of solids. After this nobody traces rays.
  Gather out;
  out.enclosed = transport::find_enclosed(scene.scene, scene.tracer, scene.elements,
                                          [&](size_t i) { return back_faces(light.hits, i); });
  free_memory(light.hits.escaped), free_memory(light.hits.met_double_sided_back);
  if (observer.on_traced) observer.on_traced();
  if (stores.keep) out.kept_direct = light.direct, out.kept_levels = light.levels;
  // 5. All bounces, by sweeps over the stored hits.
  LUXEL_TRY_STATUS(bounce_last(in, light, out, progress));
  take_result(std::move(light), out);
  return out;
}

}  // namespace luxel::gather
