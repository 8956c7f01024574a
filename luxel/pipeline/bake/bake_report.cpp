#include "luxel/pipeline/bake/bake_report.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>

#include "luxel/atlas/pages.h"
#include "luxel/base/process_memory.h"
#include "luxel/export/baked_glb.h"
#include "luxel/pipeline/settings/version.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/pipeline/solver/stage_seconds.h"
#include "luxel/scene/origin.h"

namespace luxel::pipeline {
namespace {

nlohmann::json about_atlas(const BakeSettings& settings, const Bake& bake) {
  const std::vector<atlas::Page> pages = atlas::pages_of(bake.atlas);
  nlohmann::json out = {{"resolution", 0},
                        {"kept_uv1", bake.atlas.kept},
                        {"utilisation", bake.atlas_stats.utilisation},
                        {"mean_stretch_l2", bake.atlas_stats.mean_stretch_l2},
                        {"texels_per_metre", bake.atlas_stats.texels_per_metre},
                        {"pages", nlohmann::json::array()}};
  for (size_t p = 0; p < pages.size(); ++p) {
    out["resolution"] = std::max(out["resolution"].get<int>(), pages[p].side);
    out["pages"].push_back({{"file", export_::lightmap_name(p, pages.size()) + ".exr"},
                            {"resolution", pages[p].side}});
  }
  if (bake.wrong_in_uv1)
    out["wrong_sides_in_uv1"] = {{"shown", bake.wrong_in_uv1->shown},
                                 {"all", bake.wrong_in_uv1->all}};
  if (settings.pages.mode != atlas::PageMode::per_instance) return out;
  for (uint32_t i = 0; i < bake.scene.instances.size(); ++i) {
    const uint32_t first = bake.atlas.first_triangle[i];
    if (first < bake.atlas.first_triangle[i + 1])
      out["pages"][atlas::page_of(bake.atlas, first)]["node"] = bake.scene.instances[i].name;
  }
  return out;
}

/// Drawn triangles that are the second side of another one.
size_t count_backs(const scene::Scene& scene) {
  size_t out = 0;
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[instance.mesh];
    out += mesh.other_side.size() - size_t(std::ranges::count(mesh.other_side, scene::kNone));
  }
  return out / 2;
}

/// Errors and samples of the light, and the place of its largest error.
nlohmann::json about_error(const BakeSettings& settings, const Bake& bake) {
  const std::vector<float>& errors = bake.light.errors;
  const std::vector<uint16_t>& samples = bake.light.samples;
  const size_t worst = size_t(std::max_element(errors.begin(), errors.end()) - errors.begin());
  const atlas::Texel& texel = bake.map.texels[worst];
  const DVec3 at = scene::in_world(bake.scene, scene::world_position(bake.scene, texel.sample));
  const auto [fewest, most] = std::minmax_element(samples.begin(), samples.end());
  const double all = std::accumulate(samples.begin(), samples.end(), 0.0);
  nlohmann::json out = {
      {"relative_p95", bake.light.error_p95},
      {"worst",
       {{"relative", errors[worst]},
        {"position", {at.x, at.y, at.z}},
        {"node", bake.scene.instances[texel.sample.instance].name}}},
      {"samples", {{"fewest", *fewest}, {"mean", all / double(samples.size())}, {"most", *most}}}};
  if (settings.max_error > 0) {
    out["asked"] = settings.max_error;
    out["asked_of"] = settings.error_measure == gather::ErrorMeasure::rms ? "rms" : "p95";
  }
  return out;
}

}  // namespace

double lit_share(const TexelLight& light) {
  std::vector<float> brightest;
  double all = 0;
  for (size_t i = 0; i < light.irradiance.size(); ++i) {
    if (!light.hidden.empty() && light.hidden[i]) continue;
    brightest.push_back(std::max(luminance(light.irradiance[i]), 0.0f));
    all += double(brightest.back());
  }
  if (!(all > 0)) return 1;
  std::ranges::sort(brightest, std::greater());
  double sum = 0;
  size_t count = 0;
  while (count < brightest.size() && sum < kLitPart * all) sum += double(brightest[count++]);
  return double(count) / double(brightest.size());
}

nlohmann::json bake_report(const BakeSettings& settings, const Bake& bake,
                           const Progress& progress) {
  const nlohmann::json seconds = stage_seconds(progress.stages());
  const double error = bake.light.delivered_error.value_or(bake.light.relative_error);
  const double lit = lit_share(bake.light);
  const double tracing = seconds.value("direct light", 0.0) + seconds.value("supersample", 0.0) +
                         seconds.value("trace rays", 0.0) + seconds.value("trace paths", 0.0) +
                         seconds.value("hemicubes", 0.0) + seconds.value("directions", 0.0) +
                         seconds.value("probes", 0.0);
  nlohmann::json out = {
      {"version", kVersion},
      {"settings", to_json(settings)},
      {"counts",
       {{"triangles", bake.atlas.corners.size()},
        {"triangles_of_file", bake.triangles_of_file},
        {"backs", count_backs(bake.scene)},
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
      {"device", bake.light.device.empty() ? "cpu" : bake.light.device},
      {"relative_error", error},
      {"lit_share", lit},
      {"relative_error_of_lit", error * std::sqrt(lit) / kLitPart},
      {"preview", to_json(bake.view, bake.scene.origin)},
      {"default_day", is_lit_by_default_day(settings.outside, bake.scene)},
      {"warnings", bake.warnings}};
  if (bake.light.delivered_error)
    out["relative_error_before_denoising"] = bake.light.relative_error;
  if (const DVec3 o = bake.scene.origin; o != DVec3{}) out["origin"] = {o.x, o.y, o.z};
  if (!bake.light.errors.empty()) out["error"] = about_error(settings, bake);
  return out;
}

}  // namespace luxel::pipeline
