#include "pipeline/bake.h"

#include <nlohmann/json.hpp>
#include <numeric>

#include "atlas/pages.h"
#include "base/file.h"
#include "base/parallel.h"
#include "display/draw.h"
#include "display/tone_map.h"
#include "export/baked_glb.h"
#include "image/codec.h"
#include "import/import.h"
#include "pipeline/denoise_light.h"
#include "pipeline/memory.h"
#include "pipeline/output_folder.h"
#include "pipeline/shown_light.h"
#include "pipeline/stage_seconds.h"
#include "pipeline/texel_picture.h"
#include "pipeline/two_sides.h"
#include "pipeline/version.h"
#include "pipeline/vertex_lit.h"
#include "post/dilate.h"
#include "post/refill.h"
#include "post/seams.h"
#include "scene/sides.h"
#include "transport/irradiance_field.h"

namespace luxel::pipeline {
namespace {

/// Rings of dilation: enough for bilinear lookups in four mipmap levels.
constexpr int kDilationRings = 8;
/// Hidden texels are refilled as far as a bilinear lookup from outside can reach.
constexpr int kRefillRings = 2;
constexpr int kPreviewWidth = 960, kPreviewHeight = 720;

Status not_cancelled(const Progress& progress) {
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped by the user");
  return {};
}

Result<scene::Scene> load(const BakeSettings& settings, std::vector<std::string>& warnings,
                          Progress& progress) {
  progress.begin("import", 0);
  LUXEL_TRY(import::Imported imported, import::import_scene(settings.scene));
  warnings = std::move(imported.warnings);
  LUXEL_TRY(const std::vector<std::string> light,
            add_outside_light(settings.outside, imported.scene));
  warnings.insert(warnings.end(), light.begin(), light.end());
  LUXEL_TRY_STATUS(not_cancelled(progress));
  return std::move(imported.scene);
}

Status solve(const BakeSettings& settings, const SolveInput& input, Bake& bake,
             Progress& progress) {
  const Solver& solver = *find_solver(settings.solver);
  if (!solver.scatters && scene::scatters_light(input.scene))
    bake.warnings.push_back(fmt::format(
        "light that is scattered through surfaces (KHR_materials_diffuse_transmission) is left out "
        "by --solver {}: they are too dark; gather and reference have it",
        settings.solver));
  LUXEL_TRY(bake.light, solver.solve(input, settings, progress));
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
  bake.lightmaps = post::lightmap_pages(bake.atlas, bake.map, bake.light.irradiance);
  for (image::Image& lightmap : bake.lightmaps) post::dilate(lightmap, kDilationRings);
  if (scene::scatters_light(bake.scene)) {
    bake.shown = post::lightmap_pages(
        bake.atlas, bake.map,
        shown_irradiance(bake.scene, bake.atlas, bake.map, bake.light.irradiance));
    for (image::Image& lightmap : bake.shown) post::dilate(lightmap, kDilationRings);
  }
  bake.layers = bake_layers(bake.scene, bake.atlas, bake.map, kDilationRings, bake.light);
  return not_cancelled(progress);
}

/// What is asked for besides the lightmap, from the light that the lightmap ended up with.
Status add_directions(const BakeSettings& settings, const SolveInput& input, Bake& bake,
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

nlohmann::json about_atlas(const BakeSettings& settings, const Bake& bake) {
  const std::vector<atlas::Page> pages = atlas::pages_of(bake.atlas);
  nlohmann::json out = {{"resolution", 0},
                        {"utilisation", bake.atlas_stats.utilisation},
                        {"mean_stretch_l2", bake.atlas_stats.mean_stretch_l2},
                        {"texels_per_metre", bake.atlas_stats.texels_per_metre}};
  for (size_t p = 0; p < pages.size(); ++p) {
    out["resolution"] = std::max(out["resolution"].get<int>(), pages[p].side);
    out["pages"].push_back({{"file", export_::lightmap_name(p, pages.size()) + ".exr"},
                            {"resolution", pages[p].side}});
  }
  if (settings.pages.mode != atlas::PageMode::per_instance) return out;
  for (uint32_t i = 0; i < bake.scene.instances.size(); ++i) {
    const uint32_t first = bake.atlas.first_triangle[i];
    if (first < bake.atlas.first_triangle[i + 1])
      out["pages"][atlas::page_of(bake.atlas, first)]["node"] = bake.scene.instances[i].name;
  }
  return out;
}

/// How sure the light is, and where it is least so.
nlohmann::json about_error(const BakeSettings& settings, const Bake& bake) {
  const std::vector<float>& errors = bake.light.errors;
  const std::vector<uint16_t>& samples = bake.light.samples;
  const size_t worst = size_t(std::max_element(errors.begin(), errors.end()) - errors.begin());
  const atlas::Texel& texel = bake.map.texels[worst];
  const Vec3 at = scene::world_position(bake.scene, texel.sample);
  const auto [fewest, most] = std::minmax_element(samples.begin(), samples.end());
  const double all = std::accumulate(samples.begin(), samples.end(), 0.0);
  nlohmann::json out = {
      {"relative_p95", bake.light.error_p95},
      {"worst",
       {{"relative", errors[worst]},
        {"position", {at.x, at.y, at.z}},
        {"node", bake.scene.instances[texel.sample.instance].name}}},
      {"samples", {{"fewest", *fewest}, {"mean", all / double(samples.size())}, {"most", *most}}}};
  if (settings.max_error > 0) out["asked"] = settings.max_error;
  return out;
}

nlohmann::json report(const BakeSettings& settings, const Bake& bake, const Progress& progress) {
  const nlohmann::json seconds = stage_seconds(progress);
  const double tracing = seconds.value("direct light", 0.0) + seconds.value("supersample", 0.0) +
                         seconds.value("trace rays", 0.0) + seconds.value("trace paths", 0.0) +
                         seconds.value("hemicubes", 0.0) + seconds.value("directions", 0.0) +
                         seconds.value("probes", 0.0);
  return {{"version", kVersion},
          {"settings", to_json(settings)},
          {"counts",
           {{"triangles", bake.atlas.corners.size()},
            {"texels", bake.map.texels.size()},
            {"rays", bake.light.rays},
            {"charts", bake.atlas.chart_count},
            {"seams", bake.seams},
            {"sweeps", bake.light.sweeps},
            {"elements", bake.light.elements},
            {"supersampled_texels", bake.light.supersampled_texels},
            {"suspicious_texels", bake.light.suspicious_texels}}},
          {"atlas", about_atlas(settings, bake)},
          {"leaks",
           {{"cuts", bake.repair.cuts},
            {"parted_pairs", bake.repair.parted},
            {"overlapping_texels", bake.repair.overlapping.size()},
            {"invalid_texels", std::count(bake.light.hidden.begin(), bake.light.hidden.end(), 1)},
            {"moved_samples", bake.repair.moved.size()},
            {"refilled_texels", bake.repair.refilled.size()}}},
          {"seam_residual",
           {bake.seam_residual_before.rms_over_mean, bake.seam_residual_after.rms_over_mean}},
          {"seam_residual_p95",
           {bake.seam_residual_before.relative_p95, bake.seam_residual_after.relative_p95}},
          {"seam_residual_max",
           {bake.seam_residual_before.relative_max, bake.seam_residual_after.relative_max}},
          {"seconds", seconds},
          {"mrays_per_s", tracing > 0 ? double(bake.light.rays) * 1e-6 / tracing : 0.0},
          {"peak_memory_bytes", peak_resident_bytes()},
          {"scratch_bytes", bake.light.scratch_bytes},
          {"relative_error", bake.light.relative_error},
          {"preview", to_json(bake.view)},
          {"warnings", bake.warnings}};
}

}  // namespace

Result<Bake> bake_scene(const BakeSettings& settings, Progress& progress) {
  LUXEL_TRY_STATUS(check(settings));
  const ThreadLimit threads(settings.threads);
  Bake bake;
  LUXEL_TRY(bake.scene, load(settings, bake.warnings, progress));
  LUXEL_TRY(const std::vector<std::string> sides,
            split_sides(bake.scene, settings.uv, settings.resolution, progress));
  bake.warnings.insert(bake.warnings.end(), sides.begin(), sides.end());
  LUXEL_TRY(TexelLayout layout, lay_out_texels(settings, bake.scene, progress));
  LUXEL_TRY_STATUS(not_cancelled(progress));
  bake.atlas = std::move(layout.atlas), bake.map = std::move(layout.map);
  bake.atlas_stats = layout.stats, bake.repair = std::move(layout.repair);
  const trace::RayTracer& tracer = layout.tracer;
  const transport::Elements elements =
      transport::elements_from_texels(bake.scene, bake.atlas, bake.map);
  const transport::Lights lights = transport::collect_lights(bake.scene);
  const SolveInput input{bake.scene, bake.atlas, bake.map, elements, lights, tracer};
  LUXEL_TRY_STATUS(solve(settings, input, bake, progress));
  LUXEL_TRY_STATUS(repair(settings, tracer, bake, progress));
  LUXEL_TRY_STATUS(note_lights(bake.scene, lights, settings.layers, bake.layers));
  LUXEL_TRY_STATUS(add_directions(settings, input, bake, progress));
  LUXEL_TRY_STATUS(draw_preview(tracer, bake, progress));
  return bake;
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
  const VertexLit lit = vertex_lit(bake.scene, *bake.light.field);
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

/// Everything but bake.json, and what bake.json says about it.
Result<std::vector<OutputFile>> files_of(const BakeSettings& settings, const Bake& bake,
                                         nlohmann::json& json) {
  LUXEL_TRY(LightmapFiles lightmap,
            lightmap_files(bake.lightmaps, settings.formats, settings.output));
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
  LUXEL_TRY(std::vector<std::byte> glb, glb_of(settings, bake));
  if (settings.html) {
    LUXEL_TRY(OutputFile page, view_page(settings, bake, glb));
    files.push_back(std::move(page));
  }
  files.push_back({settings.output / "baked.glb", std::move(glb)});
  for (size_t p = 0; p < bake.texel_pictures.size(); ++p) {
    const bool one = bake.texel_pictures.size() == 1;
    files.push_back({settings.output / (one ? "texels.png" : fmt::format("texels-{}.png", p)),
                     image::encode_png(bake.texel_pictures[p])});
  }
  files.push_back({settings.output / "preview.png", image::encode_png(bake.preview)});
  return files;
}

}  // namespace

Result<nlohmann::json> bake(const BakeSettings& settings, Progress& progress) {
  LUXEL_TRY_STATUS(check(settings));
  OutputFolder folder(settings.output);
  LUXEL_TRY_STATUS(folder.try_out());
  LUXEL_TRY(const Bake result, bake_scene(settings, progress));
  progress.begin(kWriteStage, 0);
  nlohmann::json about_files = nlohmann::json::object();
  LUXEL_TRY(std::vector<OutputFile> files, files_of(settings, result, about_files));
  LUXEL_TRY_STATUS(not_cancelled(progress));
  progress.finish();
  nlohmann::json json = report(settings, result, progress);
  if (!result.light.errors.empty()) json["error"] = about_error(settings, result);
  json.update(about_files);
  for (const OutputFile& file : files) json["files"].push_back(file.path.filename().string());
  json["files"].push_back("bake.json");
  files.push_back(text_file(settings.output / "bake.json", json.dump(2) + "\n"));
  LUXEL_TRY_STATUS(folder.make());
  LUXEL_TRY_STATUS(write_files_atomically(files));
  folder.keep();
  return json;
}

}  // namespace luxel::pipeline
