#include "apps/cli/cli.h"
#include "apps/cli/print.h"
#include "apps/cli/together.h"
#include "luxel/base/parallel.h"
#include "luxel/base/shown_text.h"
#include "luxel/pipeline/command/factors.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::cli {
namespace {

struct FactorOptions {
  Common common;
  int processes_per_node = 1;
  Given reading;
  pipeline::FactorSettings settings;
  std::string max_memory;
};

/// Row sums tell something only when rows are whole, reciprocity only when all rows are there.
bool has_whole_rows(const pipeline::FactorReport& r) { return r.selection.to == scene::kNone; }
bool is_whole(const pipeline::FactorReport& r) {
  return has_whole_rows(r) && r.selection.from == scene::kNone;
}

nlohmann::json report_json(const pipeline::FactorSettings& s, const pipeline::FactorReport& r) {
  nlohmann::json surfaces = nlohmann::json::array();
  for (size_t i = 0; i < r.matrix.size(); ++i) {
    nlohmann::json surface{{"name", r.matrix.names[i]}, {"area_m2", r.matrix.area_m2[i]}};
    const bool is_row = r.selection.from == scene::kNone || r.selection.from == i;
    if (is_row && has_whole_rows(r)) {
      surface["row_sum"] = r.checks.row_sum[i];
      surface["escapes"] = 1 - r.checks.row_sum[i];
    }
    surfaces.push_back(std::move(surface));
  }
  nlohmann::json json{{"output", s.output.string()},      {"method", s.method},
                      {"surfaces", std::move(surfaces)},  {"polygons", r.polygons},
                      {"largest_error", r.largest_error}, {"warnings", r.warnings}};
  if (is_whole(r)) {
    json["reciprocity_error"] = r.checks.reciprocity_error;
    json["largest_row_error"] = r.checks.largest_row_error;
    json["closed"] = r.closed;
  }
  if (r.selection.from != scene::kNone && r.selection.to != scene::kNone)
    json["factor"] = r.matrix.at(r.selection.from, r.selection.to);
  if (r.smoothing) json["smoothing"] = *r.smoothing;
  return json;
}

void print_surfaces(const pipeline::FactorReport& r) {
  std::vector<std::string> names;
  size_t width = 7;
  for (const std::string& name : r.matrix.names)
    width = std::max(width, names.emplace_back(short_message(name)).size());
  print_line(stdout, fmt::format("{:{}}  {:>12}  {:>10}  {:>10}", "surface", width, "area [m^2]",
                                 "row sum", "escapes"));
  for (size_t i = 0; i < r.matrix.size(); ++i)
    if (r.selection.from == scene::kNone || r.selection.from == i)
      print_line(stdout,
                 fmt::format("{:{}}  {:>12.6g}  {:>10.7f}  {:>10.7f}", names[i], width,
                             r.matrix.area_m2[i], r.checks.row_sum[i], 1 - r.checks.row_sum[i]));
}

void print_report(const pipeline::FactorReport& r) {
  if (has_whole_rows(r)) print_surfaces(r);
  if (r.selection.from != scene::kNone && r.selection.to != scene::kNone)
    print_line(stdout, fmt::format("F({} -> {}) = {:.12g}", r.matrix.names[r.selection.from],
                                   r.matrix.names[r.selection.to],
                                   r.matrix.at(r.selection.from, r.selection.to)));
  print_line(stdout, fmt::format("largest estimated error of a factor: {:.1e}", r.largest_error));
  if (!is_whole(r)) return;
  print_line(stdout,
             fmt::format("largest reciprocity error |A_i F_ij - A_j F_ji| / min(A_i, A_j): {:.1e}",
                         r.checks.reciprocity_error));
  print_line(stdout,
             fmt::format("closure: {}; the largest |1 - row sum| is {:.1e}",
                         r.closed ? "closed" : "open, light escapes", r.checks.largest_row_error));
  if (r.smoothing)
    print_line(stdout, fmt::format("smoothing changed a factor by at most {:.1e}", *r.smoothing));
}

/// `team`: null: this process works alone.
int run_factors(const FactorOptions& options, Team* team) {
  pipeline::FactorSettings settings = options.settings;
  if (!options.max_memory.empty()) {
    const Result<uint64_t> size = pipeline::parse_size(options.max_memory);
    if (!size) return report(size.error(), options.common);
    settings.max_memory_bytes = *size;
  }
  if (const Status read = read_given(options.reading, pipeline::import_options(), settings.reading);
      !read)
    return report(read.error(), options.common);
  pipeline::FactorReport report_of_factors;
  const Status done = run_with_progress(options.common, [&](Progress& progress) -> Status {
    const ThreadLimit threads(options.common.threads);
    LUXEL_TRY(report_of_factors, pipeline::view_factors(settings, progress, team));
    return {};
  });
  if (!done) return report(done.error(), options.common);
  print_warnings(report_of_factors.warnings, options.common);
  if (options.common.json)
    print_json(stdout, report_json(options.settings, report_of_factors));
  else if (!options.common.quiet) {
    print_report(report_of_factors);
    print_line(stderr, "wrote " + options.settings.output.string());
  }
  return kDone;
}

}  // namespace

void register_factors(CLI::App& app, Action& action) {
  CLI::App* factors =
      app.add_subcommand("factors", "Compute the view factors between the surfaces of a scene");
  auto options = std::make_shared<FactorOptions>();
  pipeline::FactorSettings& s = options->settings;
  factors->add_option("SCENE", s.scene, "The scene; each mesh instance or OBJ group is a surface")
      ->required();
  factors->add_option("-o,--output", s.output, "Table to write, .csv")->required();
  factors->add_option("--method", s.method, "How to compute them: analytic, hemicube or rays")
      ->check(CLI::IsMember({"analytic", "hemicube", "rays"}))
      ->capture_default_str();
  factors->add_option("--tolerance", s.tolerance,
                      "analytic: error limit where something stands between two surfaces, relative "
                      "to the factor, or to 1e-3 if the factor is smaller (default: 1e-4)");
  factors->add_option(
      "--samples", s.samples,
      "rays: rays per surface (default: 262144); hemicube: points per surface (default: 256)");
  factors->add_option("--hemicube", s.hemicube,
                      "hemicube: pixels along an edge of its top (default: 64)");
  factors->add_flag(
      "--smooth", s.smooth,
      "Correct the factors of a closed enclosure so that rows sum to 1 and A_i F_ij = A_j F_ji");
  factors->add_option("--from", s.from, "Only factors from this surface")->type_name("NAME");
  factors->add_option("--to", s.to, "Only factors to this surface")->type_name("NAME");
  factors->add_option(
      "--max-memory", options->max_memory,
      "Memory limit for the whole process, e.g. 900M or 1.5G (default: the free memory)");
  factors->add_option("--seed", s.seed, "Random seed")
      ->check(whole_number())
      ->capture_default_str();
  add_import(*factors, options->reading);
  add_common(*factors, options->common);
  add_processes_per_node(*factors, options->processes_per_node);
  factors->callback(
      [options, &action] { action = [options] { return run_together(*options, run_factors); }; });
}

}  // namespace luxel::cli
