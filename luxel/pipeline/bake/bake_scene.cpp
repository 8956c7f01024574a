#include "luxel/pipeline/bake/bake_scene.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "luxel/base/deadline.h"
#include "luxel/base/digest.h"
#include "luxel/base/free_memory.h"
#include "luxel/base/parallel.h"
#include "luxel/base/process_memory.h"
#include "luxel/base/share_out.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/bake/bake_device.h"
#include "luxel/pipeline/bake/bake_team.h"
#include "luxel/pipeline/bake/camera.h"
#include "luxel/pipeline/bake/dark_lamps.h"
#include "luxel/pipeline/bake/dark_surfaces.h"
#include "luxel/pipeline/bake/denoise_light.h"
#include "luxel/pipeline/bake/finish_bake.h"
#include "luxel/pipeline/bake/preview.h"
#include "luxel/pipeline/reuse/bake_cache.h"
#include "luxel/pipeline/reuse/checkpoint.h"
#include "luxel/pipeline/reuse/same_work.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/pipeline/solver/memory.h"
#include "luxel/pipeline/solver/sharing_error.h"
#include "luxel/pipeline/solver/stage_seconds.h"
#include "luxel/pipeline/texels/connected_texels.h"
#include "luxel/pipeline/texels/resolution.h"
#include "luxel/pipeline/texels/two_sides.h"
#include "luxel/scene/brightness.h"
#include "luxel/scene/sides.h"
#include "luxel/scene/validate.h"

namespace luxel::pipeline {
namespace {

/// Errors: light of a texel that overflows, or whose variance does; what follows squares both.
Status check_held(const light::TexelScene& in, const TexelLight& light) {
  const auto place = [&](size_t i) {
    return scene::world_position(in.scene, in.map.texels[i].sample);
  };
  LUXEL_TRY_STATUS(scene::check_held(in.scene, light.irradiance, place));
  for (const std::vector<Rgb>& layer : light.layer_irradiance)
    LUXEL_TRY_STATUS(scene::check_held(in.scene, layer, place));
  for (const std::vector<float>* variance : {&light.variance, &light.direct_variance})
    for (size_t i = 0; i < variance->size(); ++i)
      if (!std::isfinite((*variance)[i])) return Failure{scene::overflow_at(in.scene, place(i))};
  return {};
}

/// Hidden texels hold 0, whatever their solver found there: the one rule of leaks.md.
void clear_hidden(TexelLight& light) {
  const auto clear = [&](auto& values) {
    for (size_t i = 0; i < std::min(values.size(), light.hidden.size()); ++i)
      if (light.hidden[i]) values[i] = {};
  };
  clear(light.irradiance), clear(light.variance);
  clear(light.direct), clear(light.direct_variance);
  for (std::vector<Rgb>& layer : light.layer_irradiance) clear(layer);
}

Status solve(const BakeSettings& settings, const light::TexelScene& input,
             const SolveStores& stores, const SolveObserver& observer, Bake& bake,
             Progress& progress) {
  const Solver& solver = *find_solver(settings.solver);
  if (!solver.can.scatters && scene::scatters_light(input.scene))
    bake.warnings.push_back(fmt::format(
        "--solver {} leaves out the light that scatters through surfaces "
        "(KHR_materials_diffuse_transmission), so they are too dark; use gather or reference",
        settings.solver));
  LUXEL_TRY(bake.light, solver.solve(input, settings, stores, observer, progress));
  clear_hidden(bake.light);
  LUXEL_TRY_STATUS(check_held(input, bake.light));
  bake.warnings.insert(bake.warnings.end(), bake.light.warnings.begin(), bake.light.warnings.end());
  return {};
}

/// Charts of a kept layout may share texels, which no solver sees. Of a part of the light paths
/// know nothing.
Status add_sharing_error(const BakeSettings& settings, const light::TexelScene& in, Bake& bake,
                         Progress& progress) {
  if (bake.repair.overlapping.empty() || settings.light != LightPart::all) return {};
  LUXEL_TRY(const double shared,
            sharing_error(in, bake.light, {settings.bounces, settings.seed}, progress));
  bake.light.relative_error = std::hypot(bake.light.relative_error, shared);
  if (std::optional<double>& delivered = bake.light.delivered_error)
    delivered = std::hypot(*delivered, shared);
  return {};
}

/// Structures that light needs besides a bake's scene and texels.
struct Ready {
  trace::RayTracer tracer;
  transport::Elements elements;
  light::Lights lights;
};

/// A density that the file's own layout does not follow; empty: there is none.
std::optional<std::string> ignored_density(const scene::Scene& scene, const atlas::Atlas& atlas) {
  const auto asks = [](const scene::Instance& i) { return scene::layout_density(i) != 1; };
  const auto first = std::ranges::find_if(scene.instances, asks);
  if (!atlas.kept || first == scene.instances.end()) return std::nullopt;
  return fmt::format(
      "'{}' asks for another texel density (extras.luxel), but the file's TEXCOORD_1 is kept; give "
      "--uv unwrap for a layout with this density",
      first->name);
}

/// The use of a layout.
enum class LaysOutFor { bake, plan };

/// Splits sides and lays out what was read.
Result<TexelLayout> lay_out_anew(const BakeSettings& settings, scene::Scene& scene,
                                 const Keepers& keepers, LaysOutFor use, Progress& progress) {
  LUXEL_TRY(const double most, first_of(keepers.team, most_texels(settings), progress));
  LUXEL_TRY(SettledResolution settled, settle_resolution(settings, most, scene, progress));
  if (use == LaysOutFor::bake && !keepers.team && !keepers.device)
    expect_usual_bake(scene, settled.settings, progress);
  SidesParams params{
      .uv = settings.uv,
      .resolution = *settled.settings.resolution,
      .one_page = settings.pages.mode == atlas::PageMode::fixed && settings.pages.count == 1};
  std::vector<std::string> about_uv1;
  LUXEL_TRY(params.uv, settle_uv(scene, params, about_uv1, progress));
  // A layout that is not kept must not decide the resolution of the lightmap.
  BakeSettings of_layout = settings;
  of_layout.uv = params.uv;
  if (params.uv != settings.uv && settled.chosen && settled.chosen->uv1_area > 0) {
    LUXEL_TRY(settled, settle_resolution(of_layout, most, scene, progress));
  }
  LUXEL_TRY(Sides sides, split_sides(scene, params, progress));
  of_layout.uv = sides.uv;
  if (sides.wrong_in_uv1 && sides.uv == atlas::UvMode::unwrap) {
    LUXEL_TRY(settled, settle_resolution(of_layout, most, scene, progress));
  }
  settled.settings.uv = sides.uv;
  LUXEL_TRY(TexelLayout layout, lay_out_texels(settled.settings, scene, progress, keepers.team));
  layout.wrong_in_uv1 = sides.wrong_in_uv1, layout.warnings = std::move(about_uv1);
  layout.warnings.insert(layout.warnings.end(), sides.warnings.begin(), sides.warnings.end());
  if (std::string text = about_resolution(settled, layout.atlas, layout.stats); !text.empty())
    layout.warnings.push_back(std::move(text));
  LUXEL_TRY(std::string blended, about_blended(settled, scene, layout.atlas, layout.map, progress));
  if (!blended.empty()) layout.warnings.push_back(std::move(blended));
  return layout;
}

/// The layout of what was read, anew or as it was kept.
Result<TexelLayout> lay_out(const BakeSettings& settings, scene::Scene& scene,
                            const Keepers& keepers, LaysOutFor use, Progress& progress) {
  BakeCache* const cache = keepers.cache;
  if (KeptBake* found = cache ? cache->found() : nullptr)
    return lay_out_again(settings, std::move(found->layout), cache->change().boxes, scene,
                         progress);
  if (!cache || !cache->rays()) return lay_out_anew(settings, scene, keepers, use, progress);
  std::vector<std::vector<uint32_t>> numbers;
  const size_t materials = scene.materials.size();
  for (const scene::Mesh& mesh : scene.meshes) numbers.push_back(mesh.triangle_material);
  LUXEL_TRY(TexelLayout layout, lay_out_anew(settings, scene, keepers, use, progress));
  KeptLayout kept = keep_layout(scene, layout);
  kept.one_sided_of = one_sided_copies(numbers, materials, scene);
  cache->keep(std::move(kept));
  return layout;
}

/// Lays out bake.scene, which the tracer looks at.
Result<Ready> make_ready(const BakeSettings& settings, Bake& bake, const Keepers& keepers,
                         LaysOutFor use, Progress& progress) {
  if (keepers.checkpoint && find_solver(settings.solver)->can.parts)
    LUXEL_TRY_STATUS(keepers.checkpoint->open(bake.scene, progress));
  if (keepers.cache) keepers.cache->open(bake.scene, progress);
  LUXEL_TRY(TexelLayout layout, lay_out(settings, bake.scene, keepers, use, progress));
  bake.warnings.insert(bake.warnings.end(), layout.warnings.begin(), layout.warnings.end());
  LUXEL_TRY_STATUS(stopped(progress));
  bake.atlas = std::move(layout.atlas), bake.map = std::move(layout.map);
  bake.atlas_stats = layout.stats, bake.repair = std::move(layout.repair);
  bake.wrong_in_uv1 = layout.wrong_in_uv1;
  return_free_memory();  // of charts, bitmaps and bins: many small ones
  if (const auto ignored = ignored_density(bake.scene, bake.atlas))
    bake.warnings.push_back(*ignored);
  LUXEL_TRY(transport::Elements elements,
            transport::elements_together(bake.scene, bake.atlas, bake.map, keepers.team, progress));
  return Ready{std::move(layout.tracer), std::move(elements), light::collect_lights(bake.scene)};
}

/// A digest of where charts lie, which texel each element is and where its rays begin. On another
/// kind of machine a layout may come out differently, whose parts are of no use.
uint64_t digest_of_layout(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                          const transport::Elements& elements) {
  Digest digest;
  digest.add("layout"), digest.add(map.resolution);
  digest.add(std::span(atlas.corners));
  for (const atlas::Texel& texel : map.texels) digest.add(uint32_t(texel.x) << 16 | texel.y);
  digest.add(std::span(std::as_const(elements.position)));
  digest.add(std::span(std::as_const(elements.normal)));
  return digest.value();
}

/// Connects a solver's callbacks with those of a bake's watcher.
SolveObserver observer_of(const BakeObserver& watcher, const light::TexelScene& in) {
  SolveObserver out;
  out.on_estimate = [&](const light::LightEstimate& e) { watcher.on_estimate(in, e); };
  if (watcher.guess)
    out.guess = [&](std::span<const Rgb> direct) { return watcher.guess(in, direct); };
  if (watcher.is_watched)
    out.is_watched = [&](size_t element) { return watcher.is_watched(in, element); };
  if (watcher.on_bounce)
    out.on_bounce = [&](std::span<const Rgb> e) { return watcher.on_bounce(in, e); };
  return out;
}

/// Frees what no file of a bake holds.
void drop_parts(TexelLight& light) {
  free_memory(light.variance), free_memory(light.direct), free_memory(light.direct_variance);
}

/// The lightmaps' files by all members of a team, which have the same light: compressing them takes
/// longest of what comes after it.
Status encode_lightmaps(Team* team, Bake& bake, Progress& progress) {
  if (!team) return {};
  progress.begin("compress", 0);
  for (const image::Image& lightmap : bake.lightmaps) {
    LUXEL_TRY(std::vector<std::byte> exr, image::encode_exr_together(lightmap, team, progress));
    bake.lightmap_exr.push_back(std::move(exr));
  }
  return {};
}

/// True where the texel at a place lies inside of something.
bool is_hidden_at(const Bake& bake, const scene::SurfacePoint& p) {
  if (bake.light.hidden.empty()) return false;
  const auto& corners = bake.atlas.corners[bake.atlas.triangle_number(p.instance, p.triangle)];
  const Vec2 at = interpolate(corners[0], corners[1], corners[2], p.at);
  const int last = bake.map.resolution - 1;
  const int x = std::clamp(int(at.x), 0, last), y = std::clamp(int(at.y), 0, last);
  const uint32_t texel = bake.map.texel_at[size_t(y) * size_t(last + 1) + size_t(x)];
  return texel != atlas::kNone && bake.light.hidden[texel];
}

/// The rest of bake_scene() for a bake that has its scene.
Status bake_loaded(const BakeSettings& settings, const Keepers& wanted, const BakeObserver& watcher,
                   Bake& bake, Progress& progress) {
  LUXEL_TRY(const Keepers keepers, settle_device(settings, wanted, bake.warnings));
  LUXEL_TRY(const std::vector<uint32_t> masked, masked_lights(settings, bake.scene));
  LUXEL_TRY_STATUS(check_view(settings.view, bake.scene, settings.scene.string()));
  bake.triangles_of_file = scene::first_triangles(bake.scene).back();
  LUXEL_TRY(Ready ready, make_ready(settings, bake, keepers, LaysOutFor::bake, progress));
  const light::TexelScene input{bake.scene,     bake.atlas,   bake.map,
                                ready.elements, ready.lights, ready.tracer};
  PartStore* parts = keepers.checkpoint ? keepers.checkpoint->parts() : nullptr;
  const uint64_t layout =
      parts || keepers.team ? digest_of_layout(bake.atlas, bake.map, ready.elements) : 0;
  if (parts) parts->set_context(layout);
  LUXEL_TRY_STATUS(check_same_work(keepers.team, bake.scene, layout, progress));
  const SolveStores stores{parts, keepers.cache, keepers.device, keepers.team};
  SolveObserver observer;
  if (watcher.on_estimate)
    observer = observer_of(watcher, input);
  else if (!looks_at_places(settings))
    observer.on_traced = [&] { transport::drop_places(ready.elements); };
  hemicube::Observer inside;
  if (watcher.hemicube) inside = watcher.hemicube(input), observer.hemicube = &inside;
  LUXEL_TRY_STATUS(solve(settings, input, stores, observer, bake, progress));
  std::vector<uint32_t> regions;
  if (settings.repair_leaks) {
    LUXEL_TRY(regions, connected_texels(input, bake.light.hidden, progress, keepers.team));
  }
  if (settings.denoise)
    LUXEL_TRY_STATUS(denoise_light(input, settings, regions, bake.light, progress, keepers.team));
  LUXEL_TRY_STATUS(add_sharing_error(settings, input, bake, progress));
  LUXEL_TRY(const std::vector<std::string> failures,
            failures_of_others(keepers.team, parts ? parts->failure() : "", progress));
  bake.warnings.insert(bake.warnings.end(), failures.begin(), failures.end());
  if (keepers.cache) keepers.cache->solved();
  if (const MappedMemory* files = mapped_memory_of(input)) {
    bake.light.scratch_bytes += files->bytes_made();
    if (!watcher.on_estimate) drop_parts(bake.light);
  }
  if (is_first(keepers.team)) {
    LUXEL_TRY(bake.surface_maps,
              surface_maps(settings, input, masked, bake.light.hidden, progress));
  }
  if (settings.light == LightPart::all) {
    const std::string dark = about_dark_surfaces(bake);
    if (!dark.empty()) bake.warnings.push_back(dark);
    const std::vector<std::string> lamps =
        about_dark_lamps(bake.scene, ready.tracer,
                         [&](const scene::SurfacePoint& p) { return is_hidden_at(bake, p); });
    bake.warnings.insert(bake.warnings.end(), lamps.begin(), lamps.end());
  }
  LUXEL_TRY_STATUS(repair_light(settings, ready.tracer, regions, bake, progress, keepers.team));
  free_memory(regions);
  LUXEL_TRY_STATUS(encode_lightmaps(keepers.team, bake, progress));
  LUXEL_TRY_STATUS(leave_rest_to_first(keepers.team));
  LUXEL_TRY_STATUS(note_lights(bake.scene, ready.lights, settings.layers, bake.layers));
  LUXEL_TRY_STATUS(add_directions(settings, input, bake, progress));
  return draw_preview(settings, ready.tracer, bake, progress);
}

/// The error of a bake whose solver cannot stop by itself at the end of --time-budget.
Failure out_of_time(const BakeSettings& settings, const Progress& progress) {
  const Solver& solver = *find_solver(settings.solver);
  const std::string own =
      solver.options.empty() ? "" : " or the values of " + flags_of(solver.options);
  return fail(ErrorCode::out_of_time,
              "--time-budget {:g} ran out in the stage '{}' before --solver {} had a result; give "
              "more time, or change --resolution{}",
              settings.time_budget_s, progress.snapshot().stage, settings.solver, own);
}

/// bake_loaded(), but no longer than --time-budget where the solver does not look at the clock.
Status bake_in_time(const BakeSettings& settings, const Keepers& keepers,
                    const BakeObserver& watcher, Bake& bake, Progress& progress) {
  const bool looks_at_clock = find_solver(settings.solver)->can.errors;
  const bool is_helper = keepers.team && keepers.team->rank() > 0;  // the first one ends all
  if (settings.time_budget_s <= 0 || looks_at_clock || is_helper)
    return bake_loaded(settings, keepers, watcher, bake, progress);
  const Deadline deadline(progress, seconds_left(settings.time_budget_s, progress.stages()));
  const Status done = bake_loaded(settings, keepers, watcher, bake, progress);
  if (!done && done.error().code == ErrorCode::cancelled && deadline.passed())
    return out_of_time(settings, progress);
  return done;
}

BakeSettings with_folder(BakeSettings settings) {
  if (settings.output.empty()) settings.output = ".";
  return settings;
}

/// Errors: a scene that cannot be repaired.
Result<std::vector<std::string>> validated(scene::Scene& scene) {
  return scene::validate(scene, "scene '" + scene.name + "'");
}

}  // namespace

Result<scene::Scene> load_scene(const BakeSettings& settings, std::vector<std::string>& warnings,
                                Progress& progress) {
  progress.begin("import", 0);
  LUXEL_TRY(import::Imported imported,
            import::import_scene(settings.scene, settings.reading, settings.max_memory_bytes));
  return_free_memory();  // of documents and files: many small ones
  warnings = std::move(imported.warnings);
  LUXEL_TRY(const std::vector<std::string> light,
            add_outside_light(settings.outside, imported.scene, imported.about_lost_lights,
                              settings.max_memory_bytes));
  warnings.insert(warnings.end(), light.begin(), light.end());
  LUXEL_TRY_STATUS(stopped(progress));
  return std::move(imported.scene);
}

Result<Bake> bake_scene(const BakeSettings& settings, Progress& progress, const Keepers& keepers,
                        const BakeObserver& watcher) {
  LUXEL_TRY_STATUS(check(settings));
  const ThreadLimit threads(settings.threads);
  Bake bake;
  LUXEL_TRY(bake.scene, load_scene(settings, bake.warnings, progress));
  if (watcher.on_read) watcher.on_read(bake.scene);
  LUXEL_TRY_STATUS(bake_in_time(settings, keepers, watcher, bake, progress));
  return bake;
}

Result<Bake> bake_scene(scene::Scene scene, const BakeSettings& asked, Progress& progress,
                        const BakeObserver& watcher) {
  LUXEL_TRY_STATUS(check(with_folder(asked)));
  LUXEL_TRY(std::vector<std::string> warnings, validated(scene));
  LUXEL_TRY(const std::vector<std::string> light, add_outside_light(asked.outside, scene));
  warnings.insert(warnings.end(), light.begin(), light.end());
  LUXEL_TRY(Bake bake, bake_read_scene(std::move(scene), asked, progress, {}, watcher));
  bake.warnings.insert(bake.warnings.begin(), warnings.begin(), warnings.end());
  return bake;
}

Result<Bake> bake_read_scene(scene::Scene scene, const BakeSettings& asked, Progress& progress,
                             const Keepers& keepers, const BakeObserver& watcher) {
  const BakeSettings settings = with_folder(asked);
  LUXEL_TRY_STATUS(check(settings));
  const ThreadLimit threads(settings.threads);
  Bake bake;
  bake.scene = std::move(scene);
  LUXEL_TRY(bake.warnings, validated(bake.scene));
  LUXEL_TRY_STATUS(bake_in_time(settings, keepers, watcher, bake, progress));
  return bake;
}

Result<Plan> plan_bake(const BakeSettings& settings, Progress& progress) {
  LUXEL_TRY_STATUS(check(settings));
  const ThreadLimit threads(settings.threads);
  const Solver& solver = *find_solver(settings.solver);
  if (!solver.plan)
    return fail(ErrorCode::bad_setting, "--plan: --solver {} cannot estimate its time",
                settings.solver);
  Bake bake;
  LUXEL_TRY(bake.scene, load_scene(settings, bake.warnings, progress));
  LUXEL_TRY(const Ready ready, make_ready(settings, bake, {}, LaysOutFor::plan, progress));
  return solver.plan({bake.scene, bake.atlas, bake.map, ready.elements, ready.lights, ready.tracer},
                     settings, progress);
}

}  // namespace luxel::pipeline
