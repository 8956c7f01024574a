#include <algorithm>
#include <cmath>

#include "apps/cli/cli.h"
#include "apps/cli/print.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/command/compare.h"

namespace luxel::cli {
namespace {

struct CompareOptions {
  Common common;
  pipeline::CompareSettings settings;
  std::vector<std::optional<double>> most;  ///< per limited_measures()
};

/// Numbers for people, on stdout.
void print_table(const pipeline::Compared& c) {
  const image::Difference& d = c.difference;
  const auto line = [](const char* name, double value, const char* unit) {
    print_line(stdout, fmt::format("{:22} {:>12.6g}{}", name, value, unit));
  };
  print_line(stdout, fmt::format("{:22} {:12}", "pixels compared", d.texels));
  line("mean of B", d.mean, "");
  line("RMSE", d.rmse, "");
  line("RMSE / mean", 100 * d.rmse_over_mean, " %");
  line("relative RMSE", 100 * d.relative_rmse, " %");
  line("relative error, p95", 100 * c.relative_p95, " %");
  line("mean |A - B|", d.mean_abs, "");
  print_line(stdout, fmt::format("{:22} {:>12.6g} at ({}, {})", "largest |A - B|", d.max_abs,
                                 d.max_at[0], d.max_at[1]));
  line("bias", d.bias, "");
  line("bias / mean", 100 * d.bias_over_mean, " %");
  line("PSNR", c.psnr_db, " dB");
  line(c.hdr ? "HDR-FLIP" : "FLIP", c.flip, "");
  line("FLIP, p95", c.flip_p95, "");
  for (size_t k = 0; k < c.share_above.size(); ++k)
    print_line(stdout, fmt::format("pixels above {:2} of 255 {:>12.6g} %",
                                   image::kDifferenceLevels[k], 100 * c.share_above[k]));
}

/// The limits that were given, in the order of limited_measures().
std::vector<pipeline::Limit> limits_of(const CompareOptions& options) {
  std::vector<pipeline::Limit> limits;
  for (size_t k = 0; k < options.most.size(); ++k)
    if (options.most[k]) limits.push_back({k, *options.most[k]});
  return limits;
}

/// The measures, and what became of each limit.
nlohmann::json json_of(const pipeline::Compared& compared,
                       const std::vector<pipeline::Limit>& limits) {
  nlohmann::json json = pipeline::to_json(compared);
  if (limits.empty()) return json;
  nlohmann::json& told = json["limits"] = nlohmann::json::array();
  for (const pipeline::Limit& limit : limits)
    told.push_back({{"measure", pipeline::limited_measures()[limit.measure].key},
                    {"at_most", limit.most},
                    {"holds", pipeline::holds(limit, compared)}});
  return json;
}

int run_compare(const CompareOptions& options) {
  const std::vector<pipeline::Limit> limits = limits_of(options);
  for (const pipeline::Limit& limit : limits)
    if (!(limit.most >= 0)) {
      const std::string flag(pipeline::limited_measures()[limit.measure].flag);
      return report_usage(fmt::format("{} {} is not a number of 0 or more", flag, limit.most),
                          options.common);
    }
  pipeline::Compared compared;
  const Status done = run_with_progress(options.common, [&](Progress& progress) -> Status {
    const ThreadLimit threads(options.common.threads);
    LUXEL_TRY(compared, pipeline::compare(options.settings, progress));
    return {};
  });
  if (!done) return report(done.error(), options.common);
  print_warnings(compared.warnings, options.common);
  if (options.common.json)
    print_json(stdout, json_of(compared, limits));
  else if (!options.common.quiet)
    print_table(compared);
  if (!compared.report.empty() && !options.common.quiet)
    print_line(stderr, "wrote " + compared.report.string());
  // The last word: also when nothing else is printed.
  const std::string verdict = pipeline::verdict(compared, limits);
  if (!options.common.json && (options.common.quiet || !limits.empty()))
    print_line(stdout, verdict);
  const bool passed = std::all_of(limits.begin(), limits.end(), [&](const pipeline::Limit& limit) {
    return pipeline::holds(limit, compared);
  });
  if (passed) return kDone;
  Common said = options.common;
  said.json = false;  // the measures are there already
  return report("too_different", kBadInput, verdict, said);
}

}  // namespace

void register_compare(CLI::App& app, Action& action) {
  CLI::App* compare = app.add_subcommand("compare", "Compare two pictures or two bakes");
  auto options = std::make_shared<CompareOptions>();
  pipeline::CompareSettings& s = options->settings;
  compare
      ->add_option("IMAGE_A", s.a, "An EXR, HDR, PNG or JPEG file, or the output folder of a bake")
      ->required();
  compare->add_option("IMAGE_B", s.b, "The reference, of the same kind")->required();
  compare->add_option("--report", s.report, "Write report.html to this folder")->type_name("DIR");
  options->most.resize(pipeline::limited_measures().size());
  for (size_t k = 0; k < options->most.size(); ++k) {
    const pipeline::Limited& m = pipeline::limited_measures()[k];
    compare->add_option(std::string(m.flag), options->most[k],
                        fmt::format("Exit with code 1 if the {} is larger", m.name));
  }
  compare->add_option(
      "--exposure", s.exposure,
      "Exposure factor before tone mapping, for pictures of light (default: from B)");
  add_common(*compare, options->common);
  compare->callback([options, &action] { action = [options] { return run_compare(*options); }; });
}

}  // namespace luxel::cli
