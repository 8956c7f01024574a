#include "luxel/pipeline/command/compare_report.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/export/html_report.h"
#include "luxel/export/plot.h"
#include "luxel/image/false_color.h"

namespace luxel::pipeline {
namespace {

using export_::LegendEntry;
using export_::Panel;
using export_::Section;

LegendEntry ramp_legend(std::string label) {
  constexpr int kColors = 128;
  LegendEntry out{{}, std::move(label)};
  for (int i = 0; i < kColors; ++i) out.colors.push_back(image::false_color((i + 0.5) / kColors));
  return out;
}

LegendEntry empty_legend(const image::Mask& covered) {
  const bool all = std::find(covered.begin(), covered.end(), 0) == covered.end();
  return all ? LegendEntry{} : LegendEntry{{{128, 128, 128}}, "not compared"};
}

/// Up to the next of 1, 2, 5 times a power of ten.
double round_up(double value) {
  if (!(value > 0)) return 1;
  const double unit = std::pow(10, std::floor(std::log10(value)));
  for (const double m : {1.0, 2.0, 5.0})
    if (value <= m * unit * 1.0001) return m * unit;
  return 10 * unit;
}

/// Stands for numbers that a black reference leaves undefined.
constexpr const char* kUndefined = "—";

std::string percent(double share) {
  return std::isfinite(share) ? fmt::format("{:.3g} %", 100 * share) : kUndefined;
}

std::string decibels(double psnr) {
  if (std::isfinite(psnr)) return fmt::format("{:.2f} dB", psnr);
  return psnr > 0 ? "∞" : kUndefined;
}

std::vector<std::array<std::string, 3>> number_table(const Compared& c) {
  const image::Difference& d = c.difference;
  const auto number = [](double v) { return fmt::format("{:.4g}", v); };
  std::vector<std::array<std::string, 3>> rows{
      {"Pixels compared", fmt::format("{}", d.texels), "covered in both, alpha at least 1"},
      {"Mean of B", number(d.mean), "over pixels and channels, linear light"},
      {"RMSE", number(d.rmse), "root of the mean of (A − B)²"},
      {"RMSE / mean", percent(d.rmse_over_mean), ""},
      {"Relative RMSE", percent(d.relative_rmse),
       "root of the mean of ((A − B) / (B + 1 % of the mean))²"},
      {"Mean |A − B|", number(d.mean_abs), ""},
      {"Largest |A − B|", number(d.max_abs),
       fmt::format("at pixel ({}, {})", d.max_at[0], d.max_at[1])},
      {"Bias", number(d.bias), "mean of A − B: above 0 when A is brighter"},
      {"Bias / mean", percent(d.bias_over_mean), ""},
      {"PSNR", decibels(c.psnr_db),
       c.hdr ? "against the largest value of B" : "of display values, against 255"},
      {c.hdr ? "HDR-FLIP" : "FLIP", number(c.flip), "0: no difference is seen, 1: the largest"}};
  for (size_t k = 0; k < c.share_above.size(); ++k)
    rows.push_back({fmt::format("Pixels above {}", image::kDifferenceLevels[k]),
                    percent(c.share_above[k]),
                    "of 255, the largest channel of the display values"});
  return rows;
}

export_::Series steps(std::string name, const image::Histogram& counts, double total) {
  export_::Series s{std::move(name), {}, export_::Stroke::steps};
  for (size_t v = 0; v < counts.size(); ++v)
    s.points.push_back({double(v), 100 * double(counts[v]) / total});
  return s;
}

Panel plot_panel(export_::Plot plot, std::string caption) {
  plot.width = 560, plot.height = 340;
  return {std::move(caption), {}, export_::svg(plot), 0, {}};
}

Section histogram_section(const Measured& in, std::span<const uint8_t> bright_a,
                          std::span<const uint8_t> bright_b) {
  const double total = double(in.numbers.difference.texels);
  export_::Plot brightness{"", "brightness", "% of pixels", false, false, {}, {{0, 256}}, {}};
  brightness.series = {steps("A", image::histogram(bright_a, in.covered), total),
                       steps("B", image::histogram(bright_b, in.covered), total)};
  const image::Histogram counts =
      image::histogram(image::pixel_differences(in.shown_a, in.shown_b), in.covered);
  size_t last = 0;
  for (size_t v = 0; v < counts.size(); ++v)
    if (counts[v]) last = v;
  export_::Plot difference{"", "|A − B| of 255", "% of pixels", false, true, {}, {}, {}};
  difference.x_range = {{0, std::max(50.0, double(last + 1))}};
  difference.series = {steps("", counts, total)};
  return {"Histograms",
          "Display values, from 0 to 255.",
          {plot_panel(brightness, "Brightness of A and B"),
           plot_panel(difference, "Pixel differences (logarithmic)")}};
}

Section maps_section(const Measured& in, std::vector<image::Image8>& out) {
  const double top = round_up(image::quantile_over(in.relative, in.covered, 0.99));
  out.push_back(image::draw_map(in.relative, in.covered, 0, top));
  out.push_back(image::draw_map(in.flip, in.covered, 0, 1));
  const LegendEntry empty = empty_legend(in.covered);
  return {"Where they differ",
          "Relative error per pixel: root of the mean over the channels, denominator as in the "
          "relative RMSE. FLIP: how strongly an observer sees the difference when flipping between "
          "the two.",
          {{"Relative error",
            {},
            "",
            0,
            {ramp_legend(fmt::format("0 to {} and more", percent(top))), empty}},
           {in.numbers.hdr ? "HDR-FLIP" : "FLIP", {}, "", 0, {ramp_legend("0 to 1"), empty}}}};
}

Section contour_section(const Measured& in, std::span<const uint8_t> bright_a,
                        std::span<const uint8_t> bright_b, std::vector<image::Image8>& out) {
  std::vector<LegendEntry> legend;
  const size_t count = image::kContourLevels.size();
  for (size_t k = 0; k < count; ++k)
    legend.push_back(
        {{image::contour_color(k, count)}, fmt::format("{}", image::kContourLevels[k])});
  legend.push_back(empty_legend(in.covered));
  for (const auto& bright : {bright_a, bright_b}) {
    const int width = in.shown_a.width;
    out.push_back(
        image::draw_contours(image::contours(bright, width, in.covered, image::kContourLevels),
                             bright, width, in.covered, count));
  }
  return {"Contours",
          "Where the brightness passes through a level of 255.",
          {{"Contours of A", {}, "", 0, legend}, {"Contours of B", {}, "", 0, legend}}};
}

Section threshold_section(const Measured& in, std::vector<image::Image8>& out) {
  const std::vector<uint8_t> differences = image::pixel_differences(in.shown_a, in.shown_b);
  Section section{
      "Pixel differences", "Black: pixels that differ by more than the level, of 255.", {}};
  for (size_t k = 0; k < in.numbers.share_above.size(); ++k) {
    const uint8_t level = image::kDifferenceLevels[k];
    out.push_back(image::draw_threshold(differences, in.shown_a.width, in.covered, level));
    section.panels.push_back(
        {fmt::format("Above {}: {} of the pixels", level, percent(in.numbers.share_above[k])),
         {},
         "",
         0,
         {empty_legend(in.covered)}});
  }
  return section;
}

/// Puts the pictures, in order, into the panels that wait for one.
void encode(std::vector<image::Image8>& pictures, std::vector<Section>& sections) {
  std::vector<std::vector<std::byte>> png(pictures.size());
  parallel_for(pictures.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) png[i] = image::encode_png(pictures[i]);
  });
  size_t next = 0;
  for (Section& section : sections)
    for (Panel& panel : section.panels) {
      std::erase_if(panel.legend, [](const LegendEntry& e) { return e.label.empty(); });
      if (!panel.svg.empty()) continue;
      panel.width_px = pictures[next].width;
      panel.png = std::move(png[next++]);
    }
}

}  // namespace

std::string compare_report(const Picture& a, const Picture& b, const Measured& in,
                           const std::vector<image::Image8>& previews) {
  const Compared& c = in.numbers;
  export_::ReportPage page;
  page.title = "Comparison of two pictures";
  page.lead = {fmt::format("A: {}", a.name), fmt::format("B, the reference: {}", b.name),
               fmt::format("{} × {} pixels", b.linear.width, b.linear.height)};
  page.numbers = number_table(c);
  const std::vector<uint8_t> bright_a = image::brightness(in.shown_a);
  const std::vector<uint8_t> bright_b = image::brightness(in.shown_b);
  std::vector<image::Image8> pictures{image::draw_covered(in.shown_a, in.covered),
                                      image::draw_covered(in.shown_b, in.covered)};
  const std::string how =
      c.hdr ? fmt::format("Tone mapped, both with an exposure of {:.4g}.", c.exposure)
            : "As the files hold them.";
  page.sections.push_back({"Side by side", how, {{"A", {}, "", 0, {}}, {"B", {}, "", 0, {}}}});
  if (previews.size() == 2) {
    pictures.insert(pictures.end(), previews.begin(), previews.end());
    page.sections.push_back(
        {"The scenes", "preview.png of both bakes.", {{"A", {}, "", 0, {}}, {"B", {}, "", 0, {}}}});
  }
  page.sections.push_back(maps_section(in, pictures));
  page.sections.push_back(histogram_section(in, bright_a, bright_b));
  page.sections.push_back(contour_section(in, bright_a, bright_b, pictures));
  page.sections.push_back(threshold_section(in, pictures));
  encode(pictures, page.sections);
  return export_::html(page);
}

}  // namespace luxel::pipeline
