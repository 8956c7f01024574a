#include <cmath>
#include <cstdio>

#include "apps/cli/cli.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/command/compare.h"

namespace luxel::cli {
namespace {

struct CompareOptions {
  Common common;
  pipeline::CompareSettings settings;
  std::optional<double> max_relative_rmse;
};

/// Numbers for people, on stdout.
void print_table(const pipeline::Compared& c) {
  const image::Difference& d = c.difference;
  const auto line = [](const char* name, double value, const char* unit) {
    std::printf("%-22s %12.6g%s\n", name, value, unit);
  };
  std::printf("%-22s %12llu\n", "pixels compared", static_cast<unsigned long long>(d.texels));
  line("mean of B", d.mean, "");
  line("RMSE", d.rmse, "");
  line("RMSE / mean", 100 * d.rmse_over_mean, " %");
  line("relative RMSE", 100 * d.relative_rmse, " %");
  line("mean |A - B|", d.mean_abs, "");
  std::printf("%-22s %12.6g at (%d, %d)\n", "largest |A - B|", d.max_abs, d.max_at[0], d.max_at[1]);
  line("bias", d.bias, "");
  line("bias / mean", 100 * d.bias_over_mean, " %");
  line("PSNR", c.psnr_db, " dB");
  line(c.hdr ? "HDR-FLIP" : "FLIP", c.flip, "");
  for (size_t k = 0; k < c.share_above.size(); ++k)
    std::printf("pixels above %2d of 255 %12.6g %%\n", image::kDifferenceLevels[k],
                100 * c.share_above[k]);
}

int run_compare(const CompareOptions& options) {
  if (options.max_relative_rmse && !(*options.max_relative_rmse >= 0)) {
    std::fprintf(stderr, "luxel: --max-relative-rmse %g is not a number of 0 or more\n",
                 *options.max_relative_rmse);
    return kUsage;
  }
  pipeline::Compared compared;
  const Status done = run_with_progress(options.common, [&](Progress& progress) -> Status {
    const ThreadLimit threads(options.common.threads);
    LUXEL_TRY(compared, pipeline::compare(options.settings, progress));
    return {};
  });
  if (!done) return report(done.error());
  print_warnings(compared.warnings, options.common);
  if (options.common.json)
    std::printf("%s\n", pipeline::to_json(compared).dump(2).c_str());
  else if (!options.common.quiet)
    print_table(compared);
  if (!compared.report.empty() && !options.common.quiet)
    std::fprintf(stderr, "wrote %s\n", compared.report.c_str());
  // The exit code says whether the limit held.
  const double measured = compared.difference.relative_rmse;
  if (options.max_relative_rmse && !(measured <= *options.max_relative_rmse)) {
    std::fprintf(stderr, "luxel: the relative RMSE is %g, above --max-relative-rmse %g\n", measured,
                 *options.max_relative_rmse);
    return kBadInput;
  }
  return kDone;
}

}  // namespace

void register_compare(CLI::App& app, Action& action) {
  CLI::App* compare =
      app.add_subcommand("compare", "Hold two pictures or two bakes against each other");
  auto options = std::make_shared<CompareOptions>();
  pipeline::CompareSettings& s = options->settings;
  compare->add_option("IMAGE_A", s.a, "An EXR, HDR, PNG or JPEG file, or a folder of a bake")
      ->required();
  compare->add_option("IMAGE_B", s.b, "The reference, of the same kind")->required();
  compare->add_option("--report", s.report, "Folder in which to write report.html")
      ->type_name("DIR");
  compare->add_option("--max-relative-rmse", options->max_relative_rmse,
                      "End with code 1 when the relative RMSE is larger");
  compare->add_option("--exposure", s.exposure,
                      "Factor before tone mapping, for light; default: chosen from B");
  add_common(*compare, options->common);
  compare->callback([options, &action] { action = [options] { return run_compare(*options); }; });
}

}  // namespace luxel::cli
