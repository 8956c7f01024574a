#include "luxel/pipeline/command/factors.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "luxel/base/digest.h"
#include "luxel/base/file.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/process_memory.h"
#include "luxel/base/share_out.h"
#include "luxel/base/text_tables.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/reuse/same_work.h"
#include "luxel/scene/validate.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/viewfactor/sampled_factors.h"
#include "luxel/viewfactor/smooth_factors.h"

namespace luxel::pipeline {
namespace {

constexpr int64_t kMostSamples = 1 << 24;
constexpr int kMostPixels = 4096;
/// Characters of a number of the table: 17 digits, a point, an exponent, and a comma.
constexpr uint64_t kBytesPerNumber = 24;
/// Rays per surface where none are asked for; points of hemicubes.
constexpr int64_t kRays = 1 << 18, kPoints = 256;

/// A setting that the method would ignore is a misunderstanding.
Status check_belongs(const FactorSettings& s, bool given, const char* option, const char* methods) {
  if (!given || std::string_view(methods).find(s.method) != std::string_view::npos) return {};
  return fail(ErrorCode::bad_setting, "{} has no meaning with --method {}; it belongs to {}",
              option, s.method, methods);
}

Status check(const FactorSettings& s) {
  if (s.method != "analytic" && s.method != "hemicube" && s.method != "rays")
    return fail(ErrorCode::bad_setting, "--method {} is none of analytic, hemicube, rays",
                s.method);
  LUXEL_TRY_STATUS(check_belongs(s, s.tolerance.has_value(), "--tolerance", "analytic"));
  LUXEL_TRY_STATUS(check_belongs(s, s.samples.has_value(), "--samples", "hemicube, rays"));
  LUXEL_TRY_STATUS(check_belongs(s, s.hemicube.has_value(), "--hemicube", "hemicube"));
  if (s.tolerance && !(*s.tolerance >= 1e-9 && *s.tolerance <= 0.1))
    return fail(ErrorCode::bad_setting, "--tolerance {} is outside 1e-9 to 0.1", *s.tolerance);
  if (s.samples && (*s.samples < 1 || *s.samples > kMostSamples))
    return fail(ErrorCode::bad_setting, "--samples {} is outside 1 to {}", *s.samples,
                kMostSamples);
  if (s.hemicube && (*s.hemicube < 2 || *s.hemicube > kMostPixels || *s.hemicube % 2 != 0))
    return fail(ErrorCode::bad_setting, "--hemicube {} is not an even number from 2 to {}",
                *s.hemicube, kMostPixels);
  if (s.smooth && (!s.from.empty() || !s.to.empty()))
    return fail(ErrorCode::bad_setting,
                "--smooth needs the factors of all surfaces; leave --from and --to out");
  return s.output.empty() ? Status{} : check_output_file(s.output);
}

Result<uint32_t> surface_named(const viewfactor::Surfaces& surfaces, const char* option,
                               const std::string& name) {
  constexpr size_t kMostNames = 20;
  if (name.empty()) return scene::kNone;
  std::string names;
  for (uint32_t i = 0; i < surfaces.surfaces.size(); ++i) {
    if (surfaces.surfaces[i].name == name) return i;
    if (i < kMostNames) names += fmt::format("{}{}", i == 0 ? "" : ", ", surfaces.surfaces[i].name);
  }
  if (surfaces.surfaces.size() > kMostNames)
    names += fmt::format(" and {} more", surfaces.surfaces.size() - kMostNames);
  return fail(ErrorCode::bad_setting, "{} '{}': the scene has no such surface; choose from: {}",
              option, name, names);
}

viewfactor::SampledParams sampled_params(const FactorSettings& s) {
  viewfactor::SampledParams params;
  params.seed = s.seed;
  const bool by_rays = s.method == "rays";
  params.samples = uint32_t(s.samples.value_or(by_rays ? kRays : kPoints));
  params.hemicube = by_rays ? 0 : s.hemicube.value_or(64);
  return params;
}

Status check_memory(const FactorSettings& s, size_t surfaces) {
  const uint64_t mib = 1u << 20, needed = factor_table_bytes(surfaces, s);
  const uint64_t held = resident_bytes();
  const uint64_t free =
      s.max_memory_bytes == 0 ? available_bytes() : std::max(s.max_memory_bytes, held) - held;
  if (needed <= free) return {};
  return fail(ErrorCode::out_of_memory,
              "{}: the tables for {} surfaces{} need {} MiB of memory, and {} MiB are {}; join "
              "meshes that belong together{}{}",
              s.scene.string(), surfaces, s.smooth ? " with --smooth" : "", needed / mib + 1,
              free / mib, s.max_memory_bytes == 0 ? "free" : "left of --max-memory",
              s.method == "hemicube" ? ", lower --hemicube" : "",
              s.smooth ? ", or leave --smooth out" : "");
}

/// A mask's shape is known to rays only, and its holes have no area to radiate from: luxel does not
/// guess what was meant. By every method a surface is solid, and the names of those that were not
/// are said.
void fill_holes(const viewfactor::Surfaces& surfaces, scene::Scene& scene, FactorReport& report) {
  constexpr size_t kMostNames = 20;
  const auto is_masked = [&](uint32_t material) {
    return scene.materials[material].alpha_mode == scene::AlphaMode::mask;
  };
  std::vector<std::string> names;
  for (const viewfactor::Surface& surface : surfaces.surfaces) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[surface.instance].mesh];
    if (std::any_of(mesh.triangle_material.begin(), mesh.triangle_material.end(), is_masked))
      names.push_back(fmt::format("'{}'", surface.name));
  }
  for (scene::Material& material : scene.materials)
    if (material.alpha_mode == scene::AlphaMode::mask)
      material.alpha_mode = scene::AlphaMode::opaque;
  if (names.empty()) return;
  const size_t more = names.size() > kMostNames ? names.size() - kMostNames : 0;
  names.resize(names.size() - more);
  report.warnings.push_back(fmt::format(
      "the holes of alpha masks count as solid, in the areas and for the light that passes: {}{}",
      fmt::join(names, ", "), more ? fmt::format(" and {} more", more) : ""));
}

Result<viewfactor::Surfaces> read_surfaces(const FactorSettings& s, scene::Scene& scene,
                                           FactorReport& report, Progress& progress) {
  LUXEL_TRY(viewfactor::Surfaces surfaces, viewfactor::surfaces_of(scene, progress));
  for (const std::string& warning : surfaces.warnings)
    report.warnings.push_back(fmt::format("{}: {}", s.scene.string(), warning));
  if (surfaces.surfaces.empty())
    return fail(ErrorCode::bad_input, "{}: no surface has an area, so there are no view factors",
                s.scene.string());
  LUXEL_TRY_STATUS(check_memory(s, surfaces.surfaces.size()));
  for (const viewfactor::Surface& surface : surfaces.surfaces)
    report.polygons += surface.polygons.size();
  fill_holes(surfaces, scene, report);
  return surfaces;
}

Result<viewfactor::FactorMatrix> compute(const FactorSettings& s, const scene::Scene& scene,
                                         const viewfactor::Surfaces& surfaces,
                                         const viewfactor::FactorSelection& selection, Team* team,
                                         Progress& progress) {
  if (s.method == "analytic")
    return viewfactor::analytic_factors(surfaces, {.tolerance = s.tolerance.value_or(1e-4)},
                                        selection, progress, team);
  progress.begin("build ray tracer", 1);
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  return viewfactor::sampled_factors(scene, surfaces, tracer, sampled_params(s), selection,
                                     progress, team);
}

std::vector<size_t> chosen(uint32_t only, size_t count) {
  if (only != scene::kNone) return {only};
  std::vector<size_t> all(count);
  for (size_t i = 0; i < count; ++i) all[i] = i;
  return all;
}

/// True where every row sums to 1 within 4 standard errors of the sum (a share S of n rays or
/// pixels), or within the sum of its estimated errors, but not closer than 1e-4.
bool is_closed(const FactorSettings& s, const FactorReport& r) {
  const viewfactor::SampledParams params = sampled_params(s);
  const double rays =
      double(params.samples) * (params.hemicube > 0 ? 3 * std::pow(double(params.hemicube), 2) : 1);
  for (size_t i = 0; i < r.matrix.size(); ++i) {
    const double sum = r.checks.row_sum[i];
    double doubt = 0;
    if (s.method == "analytic")
      for (size_t j = 0; j < r.matrix.size(); ++j) doubt += r.matrix.error[i * r.matrix.size() + j];
    else
      doubt = 4 * std::sqrt(std::max(0.0, sum * (1 - sum)) / rays);
    if (std::abs(1 - sum) > std::max(1e-4, doubt)) return false;
  }
  return true;
}

/// The largest error among the entries asked for; an error for what no table may hold.
Status judge(const FactorSettings& settings, FactorReport& report) {
  const viewfactor::FactorMatrix& matrix = report.matrix;
  for (const size_t i : chosen(report.selection.from, matrix.size()))
    for (const size_t j : chosen(report.selection.to, matrix.size())) {
      if (!std::isfinite(matrix.at(i, j)))
        return fail(ErrorCode::bad_input,
                    "the factor from '{}' to '{}' is not a finite number; their coordinates are "
                    "too large",
                    matrix.names[i], matrix.names[j]);
      report.largest_error = std::max(report.largest_error, matrix.error[i * matrix.size() + j]);
    }
  report.checks = viewfactor::check_factors(matrix);
  report.closed = is_closed(settings, report);
  return {};
}

}  // namespace

uint64_t factor_table_bytes(size_t surfaces, const FactorSettings& settings) {
  const uint64_t entries = uint64_t(surfaces) * surfaces, table = sizeof(double) * entries;
  // Factors and errors stay; with them at one time either rays, the exchange areas that are
  // smoothed, or the text of the table.
  const uint64_t sampling = settings.method == "analytic" ? 0
                                                          : viewfactor::sampled_factor_bytes(
                                                                surfaces, sampled_params(settings));
  const uint64_t smoothing = settings.smooth ? table : 0;
  const bool is_part = !settings.from.empty() || !settings.to.empty();
  const uint64_t text = settings.output.empty() || is_part ? 0 : kBytesPerNumber * entries;
  return 2 * table + std::max({sampling, smoothing, text});
}

std::string factors_csv(const viewfactor::FactorMatrix& matrix,
                        const viewfactor::FactorSelection& selection) {
  const std::vector<size_t> rows = chosen(selection.from, matrix.size());
  const std::vector<size_t> columns = chosen(selection.to, matrix.size());
  std::string csv;
  csv.reserve(kBytesPerNumber * rows.size() * columns.size());
  csv = "surface";
  for (const size_t j : columns) csv.append(",").append(csv_cell(matrix.names[j]));
  csv += "\n";
  for (const size_t i : rows) {
    csv += csv_cell(matrix.names[i]);
    for (const size_t j : columns) csv += fmt::format(",{:.17g}", matrix.at(i, j));
    csv += "\n";
  }
  return csv;
}

namespace {

/// A digest of what decides how the work is shared out, and its results.
uint64_t digest_of_settings(const FactorSettings& s) {
  Digest digest;
  digest.add(s.method), digest.add(s.tolerance.value_or(0)), digest.add(s.samples.value_or(0));
  digest.add(s.hemicube.value_or(0)), digest.add(s.from), digest.add(s.to), digest.add(s.seed);
  return digest.value();
}

/// All but reading the scene. `warnings` are those of reading it.
Result<FactorReport> make_report(scene::Scene scene, std::vector<std::string> warnings,
                                 const FactorSettings& settings, Team* team, Progress& progress) {
  // The surfaces, and those that are asked for.
  FactorReport report;
  report.warnings = std::move(warnings);
  LUXEL_TRY(const viewfactor::Surfaces surfaces, read_surfaces(settings, scene, report, progress));
  LUXEL_TRY_STATUS(check_same_work(team, scene, digest_of_settings(settings), progress));
  LUXEL_TRY(report.selection.from, surface_named(surfaces, "--from", settings.from));
  LUXEL_TRY(report.selection.to, surface_named(surfaces, "--to", settings.to));
  // Their view factors, and how well they are known.
  LUXEL_TRY(report.matrix, compute(settings, scene, surfaces, report.selection, team, progress));
  LUXEL_TRY_STATUS(leave_rest_to_first(team));
  report.warnings.insert(report.warnings.end(), report.matrix.warnings.begin(),
                         report.matrix.warnings.end());
  if (settings.smooth) {
    LUXEL_TRY(report.smoothing, viewfactor::smooth_factors(report.matrix, progress));
  }
  LUXEL_TRY_STATUS(judge(settings, report));
  // The table.
  if (!settings.output.empty()) {
    progress.begin(kWriteStage, 1);
    const std::string csv = factors_csv(report.matrix, report.selection);
    LUXEL_TRY_STATUS(
        write_file_atomically(settings.output, std::as_bytes(std::span(csv.data(), csv.size()))));
  }
  return report;
}

Result<FactorReport> read_and_report(const FactorSettings& settings, Team* team,
                                     Progress& progress) {
  if (!team || team->rank() == 0) LUXEL_TRY_STATUS(check(settings));  // who writes the table
  progress.begin("read scene", 1);
  LUXEL_TRY(import::Imported imported,
            import::import_scene(settings.scene, settings.reading, settings.max_memory_bytes));
  return make_report(std::move(imported.scene), std::move(imported.warnings), settings, team,
                     progress);
}

}  // namespace

Result<FactorReport> view_factors(const FactorSettings& settings, Progress& progress, Team* team) {
  auto done = read_and_report(settings, team, progress);
  if (!done && done.error().code == ErrorCode::parts_missing) return FactorReport{};
  return or_give_up(team, std::move(done));
}

Result<FactorReport> view_factors(scene::Scene scene, const FactorSettings& settings,
                                  Progress& progress) {
  LUXEL_TRY_STATUS(check(settings));
  FactorSettings named = settings;
  if (named.scene.empty()) named.scene = "the scene";
  LUXEL_TRY(std::vector<std::string> warnings, scene::validate(scene, named.scene.string()));
  return make_report(std::move(scene), std::move(warnings), named, nullptr, progress);
}

}  // namespace luxel::pipeline
