#include "apps/cli/bake_summary.h"

#include <array>
#include <nlohmann/json.hpp>

#include "apps/cli/print.h"

namespace luxel::cli {
namespace {

/// The error of the light, as far as it is known: over the mean light, or where the most of it
/// lies on few texels over that of those, since a mean with the dark rest says nothing.
std::string error_text(const pipeline::BakeSettings& settings, const nlohmann::json& json) {
  constexpr double kMostlyLit = 0.5;
  const double rms = json["relative_error"].get<double>();
  if (rms <= 0) return {};
  const double lit = json["lit_share"].get<double>();
  const char* const of_what = json.contains("relative_error_before_denoising")
                                  ? "of the finished lightmap"
                              : settings.denoise ? "before denoising"
                                                 : "estimated";
  const std::string text =
      lit >= kMostlyLit
          ? fmt::format("error: {:.2g} % of the mean light (RMS, {})", 100 * rms, of_what)
          : fmt::format(
                "error: {:.2g} % of the light where there is any ({:.2g} % of the texels; "
                "RMS, {})",
                100 * json["relative_error_of_lit"].get<double>(), 100 * lit, of_what);
  if (settings.max_error <= 0 || !json.contains("error")) return text;
  const auto& error = json["error"];
  const auto& worst = error["worst"];
  const auto at = worst["position"].get<std::array<double, 3>>();
  return text + fmt::format(
                    "; 95 % of texels err by less than {:.3g} %; largest standard error {:.3g} % "
                    "on '{}' at {}",
                    100 * error["relative_p95"].get<double>(),
                    100 * worst["relative"].get<double>(), worst["node"].get<std::string>(),
                    json.contains("origin")
                        ? fmt::format("{:.3f}, {:.3f}, {:.3f}", at[0], at[1], at[2])
                        : fmt::format("{:.4g}, {:.4g}, {:.4g}", at[0], at[1], at[2]));
}

/// The number of triangles, and why it is more than twice the file's.
std::string triangles_text(const nlohmann::json& counts) {
  const auto all = counts["triangles"].get<uint64_t>(),
             own = counts["triangles_of_file"].get<uint64_t>(),
             fronts = all - counts["backs"].get<uint64_t>();
  if (all <= 2 * own) return fmt::format("{} triangles", all);
  return fmt::format(
      "{} triangles, {:.1f} times the file's {} ({:.1f} by backs of thin surfaces, {:.1f} by cuts "
      "where walls stand on charts)",
      all, double(all) / double(own), own, double(all) / double(fronts),
      double(fronts) / double(own));
}

}  // namespace

void print_bake(const pipeline::BakeSettings& settings, const nlohmann::json& json) {
  const auto& counts = json["counts"];
  const size_t pages = json["atlas"]["pages"].size();
  print_line(
      stderr,
      fmt::format("{}, {} charts, {}{} x {} texels ({} used), {} rays in {:.1f} s{}",
                  triangles_text(counts), counts["charts"].get<uint64_t>(),
                  pages == 1 ? "" : fmt::format("{} pages of up to ", pages),
                  json["atlas"]["resolution"].get<int>(), json["atlas"]["resolution"].get<int>(),
                  counts["texels"].get<uint64_t>(), counts["rays"].get<uint64_t>(),
                  json["seconds"]["total"].get<double>(),
                  json["device"] == "cpu" ? "" : ", with " + json["device"].get<std::string>()));
  if (const std::string error = error_text(settings, json); !error.empty())
    print_line(stderr, error);
  for (const nlohmann::json& name : json["files"])
    print_line(stderr, "wrote " + (settings.output / name.get<std::string>()).string());
}

}  // namespace luxel::cli
