#include "luxel/pipeline/command/compare.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/file.h"
#include "luxel/base/output_folder.h"
#include "luxel/display/tone_map.h"
#include "luxel/image/flip.h"
#include "luxel/pipeline/command/compare_report.h"
#include "luxel/pipeline/render/picture.h"
#include "luxel/pipeline/settings/lightmap_files.h"

namespace luxel::pipeline {
namespace {

namespace fs = std::filesystem;

/// A folder stands for the lightmap of the bake in it, or for all its pages.
Result<std::vector<fs::path>> picture_files(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return lightmaps_in(path);
  return std::vector{path};
}

/// Pages below one another, with nothing beside the smaller ones.
image::Image stacked(const std::vector<Picture>& pages) {
  int width = 0, height = 0;
  for (const Picture& page : pages) {
    width = std::max(width, page.linear.width);
    height += page.linear.height;
  }
  image::Image out(width, height, pages.front().linear.channels);
  int top = 0;
  for (const Picture& page : pages) {
    const size_t row = size_t(page.linear.width) * size_t(out.channels);
    for (int y = 0; y < page.linear.height; ++y)
      std::copy_n(page.linear.at(0, y), row, out.at(0, top + y));
    top += page.linear.height;
  }
  return out;
}

/// The picture in a file, or all lightmaps of a folder in one picture.
Result<Picture> read_subject(const fs::path& path) {
  LUXEL_TRY(const std::vector<fs::path> files, picture_files(path));
  std::vector<Picture> pages;
  for (const fs::path& file : files) {
    LUXEL_TRY(Picture page, read_picture(file));
    if (!pages.empty() && page.linear.channels != pages.front().linear.channels)
      return fail(ErrorCode::bad_input, "{} has {} channels, and {} has {}; bake the scene again",
                  page.name, page.linear.channels, pages.front().name,
                  pages.front().linear.channels);
    pages.push_back(std::move(page));
  }
  if (pages.size() == 1) return std::move(pages.front());
  return Picture{path.string(), stacked(pages), {}};
}

Status check(const CompareSettings& s) {
  for (const fs::path& path : {s.a, s.b}) {
    std::error_code ignored;
    LUXEL_TRY(const std::vector<fs::path> files, picture_files(path));
    if (fs::is_directory(path, ignored) && !fs::exists(files.front(), ignored))
      return fail(
          ErrorCode::bad_input,
          "{} is a folder without lightmap.exr; give a picture or the output folder of a bake",
          path.string());
  }
  if (s.report && s.report->empty())
    return fail(ErrorCode::bad_setting, "--report names no folder");
  if (s.report) LUXEL_TRY_STATUS(OutputFolder(*s.report).try_out());
  if (s.exposure && !(*s.exposure >= 1e-20 && *s.exposure <= 1e20))
    return fail(ErrorCode::bad_setting, "--exposure {} is not a number from 1e-20 to 1e20",
                *s.exposure);
  return {};
}

/// Light with light, display values with display values.
Status check_kinds(const Picture& a, const Picture& b) {
  if (a.hdr() == b.hdr()) return {};
  return fail(ErrorCode::bad_input,
              "{} holds light and {} display values, whose tone mapping is not known; compare two "
              "EXR or HDR files, or two PNG or JPEG files",
              a.hdr() ? a.name : b.name, a.hdr() ? b.name : a.name);
}

/// Texels that only one of both covers were laid out, not lit, differently.
void warn_of_coverage(const image::Image& a, const image::Image& b, uint64_t common,
                      std::vector<std::string>& warnings) {
  if (a.channels < 4) return;
  uint64_t in_a = 0, in_b = 0;
  for (size_t i = 3; i < a.data.size(); i += 4) in_a += a.data[i] >= 1, in_b += b.data[i] >= 1;
  const uint64_t most = std::max(in_a, in_b);
  if (double(common) < 0.99 * double(most))
    warnings.push_back(fmt::format(
        "A covers {} pixels, B {}, both only {}: the layouts differ, and pixels may show different "
        "places",
        in_a, in_b, common));
}

/// The picture as a screen shows it: its display values, or its light tone mapped, by strips, so
/// that large pictures can be stopped.
Result<image::Image8> shown_in_strips(const Picture& picture, float exposure,
                                      const Progress& progress) {
  if (!picture.hdr()) return picture.shown;
  constexpr int kRows = 256;
  const image::Image& light = picture.linear;
  const size_t row = size_t(light.width) * size_t(light.channels);
  image::Image8 out{light.width, light.height, 3, {}};
  out.data.reserve(3 * size_t(light.width) * size_t(light.height));
  for (int y = 0; y < light.height; y += kRows) {
    LUXEL_TRY_STATUS(stopped(progress));
    image::Image strip(light.width, std::min(kRows, light.height - y), light.channels);
    std::copy_n(light.data.begin() + std::ptrdiff_t(row * size_t(y)), strip.data.size(),
                strip.data.begin());
    const image::Image8 shown = display::tone_map(strip, exposure);
    out.data.insert(out.data.end(), shown.data.begin(), shown.data.end());
  }
  return out;
}

Result<image::Image> flip_map(const Picture& a, const Picture& b, const image::Mask& covered,
                              Progress& progress) {
  const uint64_t rows = uint64_t(b.linear.height);
  const image::FlipParams params{.progress = &progress};
  progress.begin(b.hdr() ? "exposures" : "flip", rows);
  const image::Image filled = image::with_uncovered_of(a.linear, b.linear, covered);
  image::Image map;
  if (b.hdr()) {
    const image::FlipExposures exposures = image::flip_exposures(b.linear, covered, &progress);
    LUXEL_TRY_STATUS(stopped(progress));
    progress.begin("flip", rows * uint64_t(exposures.count));
    map = image::hdr_flip(filled, b.linear, exposures, params);
  } else {
    map = image::flip(filled, b.linear, params);
  }
  LUXEL_TRY_STATUS(stopped(progress));
  return map;
}

/// [dB] of display values against 255.
double psnr_of_display(const image::Image8& a, const image::Image8& b, const image::Mask& covered) {
  image::Image fa(a.width, a.height, a.channels), fb = fa;
  for (size_t i = 0; i < a.data.size(); ++i) fa.data[i] = a.data[i], fb.data[i] = b.data[i];
  const double rmse = image::difference(fa, fb, covered).rmse;
  return rmse > 0 ? 20 * std::log10(255 / rmse) : INFINITY;
}

/// The previews of two bakes, when both are there and can be read.
std::vector<image::Image8> previews_of(const CompareSettings& s) {
  std::vector<image::Image8> out;
  for (const fs::path& folder : {s.a, s.b}) {
    std::error_code ignored;
    if (!fs::exists(folder / "preview.png", ignored)) return {};
    Result<Picture> preview = read_picture(folder / "preview.png");
    if (!preview || preview->hdr()) return {};
    out.push_back(std::move(preview->shown));
  }
  return out;
}

Result<fs::path> write_report(const fs::path& folder, const std::string& html) {
  OutputFolder output(folder);
  LUXEL_TRY_STATUS(output.make());
  const fs::path file = folder / "report.html";
  LUXEL_TRY_STATUS(write_file_atomically(file, std::as_bytes(std::span(html.data(), html.size()))));
  output.keep();
  return file;
}

nlohmann::json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace

Result<Measured> measure(const Picture& a, const Picture& b, std::optional<double> exposure,
                         Progress& progress) {
  progress.begin("measure", 0);
  Measured out;
  LUXEL_TRY_STATUS(check_kinds(a, b));
  if (exposure && !b.hdr())
    return fail(ErrorCode::bad_setting,
                "--exposure {} has no meaning for display values, which are compared as the files "
                "hold them; leave it out",
                *exposure);
  LUXEL_TRY(out.covered, image::covered_pixels(a.linear, a.name, b.linear, b.name));
  Compared& n = out.numbers;
  n.hdr = b.hdr();
  n.difference = image::difference(a.linear, b.linear, out.covered, &progress);
  LUXEL_TRY_STATUS(stopped(progress));
  warn_of_coverage(a.linear, b.linear, n.difference.texels, n.warnings);

  if (n.hdr) n.exposure = exposure.value_or(double(display::auto_exposure(b.linear)));
  LUXEL_TRY_STATUS(stopped(progress));
  LUXEL_TRY(out.shown_a, shown_in_strips(a, float(n.exposure), progress));
  LUXEL_TRY(out.shown_b, shown_in_strips(b, float(n.exposure), progress));
  LUXEL_TRY_STATUS(stopped(progress));
  n.psnr_db = n.hdr ? n.difference.psnr_db : psnr_of_display(out.shown_a, out.shown_b, out.covered);
  const image::Histogram differences =
      image::histogram(image::pixel_differences(out.shown_a, out.shown_b), out.covered);
  for (size_t k = 0; k < n.share_above.size(); ++k)
    n.share_above[k] = image::share_above(differences, image::kDifferenceLevels[k]);

  LUXEL_TRY(out.flip, flip_map(a, b, out.covered, progress));
  n.flip = image::mean_over(out.flip, out.covered);
  n.flip_p95 = image::quantile_over(out.flip, out.covered, 0.95);
  out.relative = image::relative_error_map(a.linear, b.linear, out.covered, n.difference.mean);
  n.relative_p95 = image::quantile_over(out.relative, out.covered, 0.95);
  return out;
}

Result<Compared> compare(const CompareSettings& s, Progress& progress) {
  LUXEL_TRY_STATUS(check(s));
  if (s.report) LUXEL_TRY_STATUS(OutputFolder(*s.report).try_out());
  progress.begin("read", 0);
  LUXEL_TRY(const Picture a, read_subject(s.a));
  LUXEL_TRY(const Picture b, read_subject(s.b));
  LUXEL_TRY(Measured measured, measure(a, b, s.exposure, progress));
  if (s.report) {
    progress.begin("report", 0);
    const std::string html = compare_report(a, b, measured, previews_of(s));
    progress.begin(kWriteStage, 0);
    LUXEL_TRY(measured.numbers.report, write_report(*s.report, html));
  }
  return std::move(measured.numbers);
}

std::span<const Limited> limited_measures() {
  static constexpr std::array kMeasures{
      Limited{"--max-relative-rmse", "relative_rmse", "relative RMSE",
              [](const Compared& c) { return c.difference.relative_rmse; }},
      Limited{"--max-relative-p95", "relative_p95", "95th percentile of the relative error",
              [](const Compared& c) { return c.relative_p95; }},
      Limited{"--max-rmse-over-mean", "rmse_over_mean", "RMSE over the mean",
              [](const Compared& c) { return c.difference.rmse_over_mean; }},
      Limited{"--max-flip", "flip", "FLIP", [](const Compared& c) { return c.flip; }},
      Limited{"--max-flip-p95", "flip_p95", "95th percentile of FLIP",
              [](const Compared& c) { return c.flip_p95; }}};
  return kMeasures;
}

bool holds(const Limit& limit, const Compared& compared) {
  return limited_measures()[limit.measure].of(compared) <= limit.most;
}

std::string verdict(const Compared& compared, std::span<const Limit> limits) {
  std::string text;
  const auto add = [&](const Limited& m) {
    text += fmt::format("{}{} {:.6g}", text.empty() ? "" : ", ", m.name, m.of(compared));
  };
  if (limits.empty()) {
    for (const Limited& m : limited_measures()) add(m);
    return text;
  }
  bool all_hold = true;
  for (const Limit& limit : limits) {
    const bool held = holds(limit, compared);
    add(limited_measures()[limit.measure]);
    text += fmt::format(" ({} {})", held ? "at most" : "above", limit.most);
    all_hold = all_hold && held;
  }
  return (all_hold ? "pass: " : "fail: ") + text;
}

nlohmann::json to_json(const Compared& c) {
  const image::Difference& d = c.difference;
  return {{"rmse", d.rmse},
          {"rmse_over_mean", number_or_null(d.rmse_over_mean)},
          {"relative_rmse", number_or_null(d.relative_rmse)},
          {"bias", d.bias},
          {"bias_over_mean", number_or_null(d.bias_over_mean)},
          {"mean_abs", d.mean_abs},
          {"max_abs", d.max_abs},
          {"max_abs_at", d.max_at},
          {"mean_of_b", d.mean},
          {"psnr_db", number_or_null(c.psnr_db)},
          {"relative_p95", c.relative_p95},
          {"flip", c.flip},
          {"flip_p95", c.flip_p95},
          {"texels", d.texels},
          {"share_above_10", c.share_above[0]},
          {"share_above_25", c.share_above[1]},
          {"share_above_40", c.share_above[2]},
          {"exposure", c.exposure},
          {"hdr", c.hdr}};
}

}  // namespace luxel::pipeline
