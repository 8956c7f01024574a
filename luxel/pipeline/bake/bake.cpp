#include "luxel/pipeline/bake/bake.h"

#include <array>
#include <functional>
#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/parallel.h"
#include "luxel/base/process_memory.h"
#include "luxel/display/draw.h"
#include "luxel/display/tone_map.h"
#include "luxel/export/baked_glb.h"
#include "luxel/image/codec.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/bake/bake_report.h"
#include "luxel/pipeline/bake/denoise_light.h"
#include "luxel/pipeline/reuse/bake_cache.h"
#include "luxel/pipeline/reuse/checkpoint.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/pipeline/solver/memory.h"
#include "luxel/pipeline/solver/solvers.h"
#include "luxel/pipeline/texels/shown_light.h"
#include "luxel/pipeline/texels/texel_picture.h"
#include "luxel/pipeline/texels/two_sides.h"
#include "luxel/post/dilate.h"
#include "luxel/post/refill.h"
#include "luxel/post/seams.h"
#include "luxel/scene/sides.h"
#include "luxel/scene/validate.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::pipeline {
namespace {

/// Rings of dilation: enough for bilinear lookups in four mipmap levels.
constexpr int kDilationRings = 8;
/// Hidden texels are refilled as far as a bilinear lookup from outside can reach.
constexpr int kRefillRings = 2;
constexpr int kPreviewWidth = 960, kPreviewHeight = 720;

Result<scene::Scene> load(const BakeSettings& settings, std::vector<std::string>& warnings,
                          Progress& progress) {
  progress.begin("import", 0);
  LUXEL_TRY(import::Imported imported, import::import_scene(settings.scene));
  warnings = std::move(imported.warnings);
  LUXEL_TRY(const std::vector<std::string> light,
            add_outside_light(settings.outside, imported.scene));
  warnings.insert(warnings.end(), light.begin(), light.end());
  LUXEL_TRY_STATUS(stopped(progress));
  return std::move(imported.scene);
}

Status solve(const BakeSettings& settings, const light::TexelScene& input,
             const SolveStores& stores, const SolveObserver& observer, Bake& bake,
             Progress& progress) {
  const Solver& solver = *find_solver(settings.solver);
  if (!solver.can.scatters && scene::scatters_light(input.scene))
    bake.warnings.push_back(fmt::format(
        "light that is scattered through surfaces (KHR_materials_diffuse_transmission) is left out "
        "by --solver {}: they are too dark; gather and reference have it",
        settings.solver));
  LUXEL_TRY(bake.light, solver.solve(input, settings, stores, observer, progress));
  if (settings.denoise) LUXEL_TRY_STATUS(denoise_light(input, bake.light, progress));
  bake.warnings.insert(bake.warnings.end(), bake.light.warnings.begin(), bake.light.warnings.end());
  return {};
}

Status stitch(std::span<const post::Seam> seams, Bake& bake, Progress& progress) {
  std::vector<Rgb> before;
  if (!bake.light.layers.empty()) before = bake.light.irradiance;
  LUXEL_TRY_STATUS(post::stitch_seams(bake.map, seams, {}, bake.light.irradiance, progress));
  if (before.empty()) return {};
  return stitch_layers(bake.map, seams, before, bake.light.irradiance, bake.light.layer_irradiance,
                       progress);
}

Status repair(const BakeSettings& settings, const trace::RayTracer& tracer, Bake& bake,
              Progress& progress) {
  progress.begin("seams", 0);
  const std::span<const uint8_t> hidden = bake.light.hidden;
  const post::Parted parted = settings.repair_leaks
                                  ? parted_texels(bake.scene, bake.atlas, bake.map, tracer)
                                  : post::Parted{};
  std::vector<std::span<Rgb>> arrays{bake.light.irradiance};
  for (std::vector<Rgb>& layer : bake.light.layer_irradiance) arrays.push_back(layer);
  bake.repair.refilled =
      post::refill_hidden(bake.atlas, bake.map, hidden, kRefillRings, parted, arrays);
  std::vector<post::Seam> seams = post::find_seams(bake.scene, bake.atlas);
  if (settings.repair_leaks) seams = open_seams(bake.scene, bake.atlas, tracer, std::move(seams));
  bake.seam_residual_before = post::seam_residual(bake.map, seams, bake.light.irradiance);
  bake.seams = seams.size();
  if (settings.stitch) LUXEL_TRY_STATUS(stitch(seams, bake, progress));
  bake.seam_residual_after = post::seam_residual(bake.map, seams, bake.light.irradiance);
  if (settings.texels)
    bake.texel_pictures =
        draw_texels(bake.atlas, bake.map,
                    {hidden, bake.repair.overlapping, bake.repair.moved, bake.repair.refilled,
                     post::seam_errors(bake.map, seams, bake.light.irradiance)});
  if (settings.error_map)
    bake.error_pictures = draw_errors(bake.atlas, bake.map, bake.light.errors);
  bake.lightmaps = post::lightmap_pages(bake.atlas, bake.map, bake.light.irradiance);
  for (image::Image& lightmap : bake.lightmaps) post::dilate(lightmap, kDilationRings);
  if (scene::scatters_light(bake.scene)) {
    bake.shown = post::lightmap_pages(
        bake.atlas, bake.map,
        shown_irradiance(bake.scene, bake.atlas, bake.map, bake.light.irradiance));
    for (image::Image& lightmap : bake.shown) post::dilate(lightmap, kDilationRings);
  }
  bake.layers = bake_layers(bake.scene, bake.atlas, bake.map, kDilationRings, bake.light);
  return stopped(progress);
}

/// What is asked for besides the lightmap, from the light that the lightmap ended up with.
Status add_directions(const BakeSettings& settings, const light::TexelScene& input, Bake& bake,
                      Progress& progress) {
  const std::span<const Rgb> light = bake.light.irradiance;
  if (settings.directional != Directional::none) {
    LUXEL_TRY(bake.directions, direction_maps(input, light, bake.light.hidden, settings.directional,
                                              settings.seed, progress));
    bake.light.rays += bake.directions.rays;
  }
  if (settings.probe_spacing_m > 0) {
    LUXEL_TRY(bake.probes,
              probe_grid(input, light, float(settings.probe_spacing_m), settings.seed, progress));
    bake.light.rays += bake.probes->rays;
  }
  return {};
}

Status draw_preview(const trace::RayTracer& tracer, Bake& bake, Progress& progress) {
  const transport::TexelField field{&bake.atlas, &bake.map, bake.light.irradiance};
  display::DrawParams params;
  params.width = kPreviewWidth, params.height = kPreviewHeight;
  const float aspect = float(params.width) / float(params.height);
  const scene::Camera camera = bake.scene.cameras.empty()
                                   ? display::fit_camera(bake.scene, tracer, aspect)
                                   : bake.scene.cameras.front();
  if (camera.aspect > 0) params.width = int(float(params.height) * camera.aspect + 0.5f);
  params.width = std::clamp(params.width, params.height / 4, params.height * 4);
  LUXEL_TRY(const image::Image picture,
            display::draw(
                bake.scene, tracer, camera,
                [&](const scene::SurfacePoint& p) { return transport::irradiance_at(field, p); },
                params, progress));
  bake.view = {camera, params.width, params.height, display::auto_exposure(picture)};
  bake.preview = display::tone_map(picture, bake.view.exposure);
  return {};
}

/// What light needs besides a bake's scene and texels.
struct Ready {
  trace::RayTracer tracer;
  transport::Elements elements;
  light::Lights lights;
};

/// The layout of what was read; warnings of it are added to `warnings`.
Result<TexelLayout> lay_out(const BakeSettings& settings, scene::Scene& scene, BakeCache* cache,
                            std::vector<std::string>& warnings, Progress& progress) {
  std::vector<std::string> sides;
  const auto warn = [&] { warnings.insert(warnings.end(), sides.begin(), sides.end()); };
  if (KeptBake* found = cache ? cache->found() : nullptr) {
    sides = found->layout.warnings, warn();
    return lay_out_again(settings, std::move(found->layout), cache->change().boxes, scene,
                         progress);
  }
  const bool keeps = cache && cache->rays();
  std::vector<std::vector<uint32_t>> numbers;
  const size_t materials = scene.materials.size();
  if (keeps)
    for (const scene::Mesh& mesh : scene.meshes) numbers.push_back(mesh.triangle_material);
  LUXEL_TRY(sides, split_sides(scene, settings.uv, settings.resolution, progress));
  warn();
  const std::vector<uint32_t> copies =
      keeps ? one_sided_copies(numbers, materials, scene) : std::vector<uint32_t>{};
  LUXEL_TRY(TexelLayout layout, lay_out_texels(settings, scene, progress));
  if (!keeps) return layout;
  KeptLayout kept = keep_layout(scene, layout);
  kept.one_sided_of = copies, kept.warnings = std::move(sides);
  cache->keep(std::move(kept));
  return layout;
}

/// Lays out bake.scene, which the tracer looks at.
Result<Ready> make_ready(const BakeSettings& settings, Bake& bake, const Keepers& keepers,
                         Progress& progress) {
  if (keepers.checkpoint && find_solver(settings.solver)->can.parts)
    LUXEL_TRY_STATUS(keepers.checkpoint->open(bake.scene, progress));
  if (keepers.cache) keepers.cache->open(bake.scene, progress);
  LUXEL_TRY(TexelLayout layout,
            lay_out(settings, bake.scene, keepers.cache, bake.warnings, progress));
  LUXEL_TRY_STATUS(stopped(progress));
  bake.atlas = std::move(layout.atlas), bake.map = std::move(layout.map);
  bake.atlas_stats = layout.stats, bake.repair = std::move(layout.repair);
  return_free_memory();  // of charts, bitmaps and bins: many small ones
  return Ready{std::move(layout.tracer),
               transport::elements_from_texels(bake.scene, bake.atlas, bake.map),
               light::collect_lights(bake.scene)};
}

/// The rest of bake_scene() for a bake that has its scene.
Status bake_loaded(const BakeSettings& settings, const Keepers& keepers,
                   const OnBakeEstimate& on_estimate, Bake& bake, Progress& progress) {
  LUXEL_TRY(Ready ready, make_ready(settings, bake, keepers, progress));
  const light::TexelScene input{bake.scene,     bake.atlas,   bake.map,
                                ready.elements, ready.lights, ready.tracer};
  const SolveStores stores{keepers.checkpoint ? keepers.checkpoint->parts() : nullptr,
                           keepers.cache};
  SolveObserver observer;
  if (on_estimate)
    observer.on_estimate = [&](const light::LightEstimate& e) { on_estimate(input, e); };
  else if (!looks_at_places(settings))
    observer.on_traced = [&] { transport::drop_places(ready.elements); };
  LUXEL_TRY_STATUS(solve(settings, input, stores, observer, bake, progress));
  if (keepers.cache) keepers.cache->solved();
  LUXEL_TRY_STATUS(repair(settings, ready.tracer, bake, progress));
  LUXEL_TRY_STATUS(note_lights(bake.scene, ready.lights, settings.layers, bake.layers));
  LUXEL_TRY_STATUS(add_directions(settings, input, bake, progress));
  return draw_preview(ready.tracer, bake, progress);
}

}  // namespace

Result<Bake> bake_scene(const BakeSettings& settings, Progress& progress, const Keepers& keepers,
                        const OnBakeEstimate& on_estimate) {
  LUXEL_TRY_STATUS(check(settings));
  const ThreadLimit threads(settings.threads);
  Bake bake;
  LUXEL_TRY(bake.scene, load(settings, bake.warnings, progress));
  LUXEL_TRY_STATUS(bake_loaded(settings, keepers, on_estimate, bake, progress));
  return bake;
}

Result<Bake> bake_scene(scene::Scene scene, const BakeSettings& asked, Progress& progress) {
  BakeSettings settings = asked;
  if (settings.output.empty()) settings.output = ".";
  LUXEL_TRY_STATUS(check(settings));
  const ThreadLimit threads(settings.threads);
  Bake bake;
  bake.scene = std::move(scene);
  LUXEL_TRY(bake.warnings, scene::validate(bake.scene, "scene '" + bake.scene.name + "'"));
  LUXEL_TRY(const std::vector<std::string> light, add_outside_light(settings.outside, bake.scene));
  bake.warnings.insert(bake.warnings.end(), light.begin(), light.end());
  LUXEL_TRY_STATUS(bake_loaded(settings, {}, {}, bake, progress));
  return bake;
}

Result<Plan> plan_bake(const BakeSettings& settings, Progress& progress) {
  LUXEL_TRY_STATUS(check(settings));
  const ThreadLimit threads(settings.threads);
  const Solver& solver = *find_solver(settings.solver);
  if (!solver.plan)
    return fail(ErrorCode::bad_setting, "--plan: --solver {} cannot say what it will take",
                settings.solver);
  Bake bake;
  LUXEL_TRY(bake.scene, load(settings, bake.warnings, progress));
  LUXEL_TRY(const Ready ready, make_ready(settings, bake, {}, progress));
  return solver.plan({bake.scene, bake.atlas, bake.map, ready.elements, ready.lights, ready.tracer},
                     settings, progress);
}

namespace {

const std::vector<image::Image>& shown_lightmaps(const Bake& bake) {
  return bake.shown.empty() ? bake.lightmaps : bake.shown;
}

/// As viewers want them; without pictures only what is said of them.
std::vector<export_::LightmapLayer> shown_layers(const Bake& bake, bool with_pictures) {
  std::vector<export_::LightmapLayer> out;
  for (const BakedLayer& layer : bake.layers) {
    out.push_back({layer.about.name, layer.about.lights, layer.instances, layer.surroundings, {}});
    if (with_pictures) out.back().lightmaps = layer.shown.empty() ? layer.lightmaps : layer.shown;
  }
  return out;
}

Result<std::vector<std::byte>> glb_of(const BakeSettings& settings, const Bake& bake) {
  if (!settings.vertex_colors)
    return export_::baked_glb(bake.scene, bake.atlas, shown_lightmaps(bake),
                              shown_layers(bake, true));
  const VertexLit& lit = *bake.light.vertex_lit;
  return export_::vertex_lit_glb(lit.scene, lit.intensity);
}

/// `glb` is baked.glb. Where that holds light per vertex, or pictures of layers, which the page has
/// already, the page has one of its own.
Result<OutputFile> view_page(const BakeSettings& settings, const Bake& bake,
                             std::span<const std::byte> glb) {
  std::vector<std::byte> own;
  const std::vector<export_::LightmapLayer> layers = shown_layers(bake, true);
  if (settings.vertex_colors || !layers.empty()) {
    LUXEL_TRY(own, export_::baked_glb(bake.scene, bake.atlas, shown_lightmaps(bake),
                                      shown_layers(bake, false)));
    glb = own;
  }
  LUXEL_TRY(const std::string html,
            export_::view_html({settings.scene.stem().string(), bake.view, bake.scene.background,
                                bake.atlas.corners.size(), glb, shown_lightmaps(bake),
                                &bake.scene.environment, layers}));
  return text_file(settings.output / "view.html", html);
}

/// kind.png, or kind-0.png and so on of several pages.
std::vector<OutputFile> picture_files(std::span<const image::Image8> pages, std::string_view kind,
                                      const std::filesystem::path& folder) {
  std::vector<OutputFile> files;
  for (size_t p = 0; p < pages.size(); ++p) {
    const std::string number = pages.size() == 1 ? "" : fmt::format("-{}", p);
    files.push_back({folder / fmt::format("{}{}.png", kind, number), image::encode_png(pages[p])});
  }
  return files;
}

/// What takes longest to encode.
struct Encoded {
  Result<LightmapFiles> lightmap;
  Result<std::vector<std::byte>> glb;
  std::vector<std::byte> preview;
};

/// At the same time: each is work for one thread, more or less.
Encoded encode(const BakeSettings& settings, const Bake& bake) {
  Encoded out;
  const std::array<std::function<void()>, 3> tasks{
      [&] { out.lightmap = lightmap_files(bake.lightmaps, settings.formats, settings.output); },
      [&] { out.glb = glb_of(settings, bake); },
      [&] { out.preview = image::encode_png(bake.preview); }};
  parallel_for(tasks.size(), 1, [&](size_t task, size_t) { tasks[task](); });
  return out;
}

/// Everything but bake.json, and what bake.json says about it.
Result<std::vector<OutputFile>> files_of(const BakeSettings& settings, const Bake& bake,
                                         nlohmann::json& json) {
  Encoded encoded = encode(settings, bake);
  LUXEL_TRY(LightmapFiles lightmap, std::move(encoded.lightmap));
  LUXEL_TRY(std::vector<std::byte> glb, std::move(encoded.glb));
  std::vector<OutputFile> files = std::move(lightmap.files);
  if (lightmap.rgbm_range > 0) json["lightmap"]["rgbm_range"] = lightmap.rgbm_range;
  const auto append = [&](std::vector<OutputFile> more) {
    std::move(more.begin(), more.end(), std::back_inserter(files));
  };
  if (!bake.layers.empty()) {
    LUXEL_TRY(std::vector<OutputFile> layers,
              layer_files(bake.layers, settings.formats, settings.output, json["layers"]));
    append(std::move(layers));
  }
  LUXEL_TRY(std::vector<OutputFile> directions, direction_files(bake.directions, settings.output));
  append(std::move(directions));
  if (bake.probes) {
    LUXEL_TRY(std::vector<OutputFile> probes, probe_files(*bake.probes, settings.output));
    append(std::move(probes));
    json["probes"] = {{"placed", bake.probes->probes.size()},
                      {"inside_solids", bake.probes->row.size() - bake.probes->probes.size()}};
  }
  if (settings.html) {
    LUXEL_TRY(OutputFile page, view_page(settings, bake, glb));
    files.push_back(std::move(page));
  }
  files.push_back({settings.output / "baked.glb", std::move(glb)});
  append(picture_files(bake.texel_pictures, "texels", settings.output));
  append(picture_files(bake.error_pictures, "error", settings.output));
  files.push_back({settings.output / "preview.png", std::move(encoded.preview)});
  return files;
}

}  // namespace

namespace {

/// A full disk has room when the checkpoint, and what is kept for later bakes, are gone.
Status write_results(std::span<const OutputFile> files, Checkpoint& checkpoint, BakeCache& cache) {
  const Status written = write_files_atomically(files);
  if (written || written.error().code != ErrorCode::out_of_disk) return written;
  const bool has_file = checkpoint.has_file();
  if (!cache.make_room() && !has_file) return written;
  checkpoint.remove();
  return write_files_atomically(files);
}

}  // namespace

Result<nlohmann::json> bake(const BakeSettings& settings, Progress& progress) {
  LUXEL_TRY_STATUS(check(settings));
  const ThreadLimit threads(settings.threads);
  OutputFolder folder(settings.output);
  LUXEL_TRY_STATUS(folder.hold(progress));
  Checkpoint checkpoint(settings, settings_of_checkpoint(settings));
  BakeCache cache(settings, settings_of_kept_bake(settings));
  LUXEL_TRY(Bake result, bake_scene(settings, progress, {&checkpoint, &cache}));
  if (checkpoint.parts() != nullptr && checkpoint.parts()->has_failed())
    result.warnings.push_back(checkpoint.parts()->failure());
  if (!cache.failure().empty()) result.warnings.push_back(cache.failure());
  progress.begin(kWriteStage, 0);
  nlohmann::json about_files = nlohmann::json::object();
  LUXEL_TRY(std::vector<OutputFile> files, files_of(settings, result, about_files));
  LUXEL_TRY_STATUS(stopped(progress));
  progress.finish();
  nlohmann::json json = bake_report(settings, result, progress);
  json["checkpoint"] = checkpoint.about();
  json["cache"] = cache.about(result.light);
  json.update(about_files);
  for (const OutputFile& file : files) json["files"].push_back(file.path.filename().string());
  json["files"].push_back("bake.json");
  files.push_back(text_file(settings.output / "bake.json", json.dump(2) + "\n"));
  LUXEL_TRY_STATUS(folder.make());
  LUXEL_TRY_STATUS(write_results(files, checkpoint, cache));
  folder.keep();
  checkpoint.remove();
  cache.finish(progress);
  return json;
}

}  // namespace luxel::pipeline
