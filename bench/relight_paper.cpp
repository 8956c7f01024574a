// The paper's figures as tables and plots. [Shcherbakov17, figures 1 to 4, 7, 11, 12]
#include "bench/relight_paper.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "luxel/base/parallel.h"
#include "luxel/export/plot.h"

namespace luxel::bench {
namespace {

/// [Shcherbakov17, figure 7]: average, largest and total error.
constexpr double kPaperErrors[3][3] = {
    {1.28e-6, 0.4622, 47.12}, {8.13e-7, 0.4684, 18.86}, {5.88e-7, 0.1524, 9.40}};
constexpr std::array kOrders{"without reordering", "rows", "rows and columns"};

Table kept_table(const PaperRuns& runs) {
  Table t = new_table(
      "relight, figure 2: error against what is kept",
      {"kept", "total error, as in the paper", "of all", "total error, by default", "of all"});
  for (size_t k = 0; k < runs.kept.size(); ++k)
    t.rows.push_back(
        {fmt::format("{:.1f} %", 100 * runs.kept[k]), fmt::format("{:.1f}", runs.of_kept[k].total),
         percent(runs.of_kept[k].relative), fmt::format("{:.1f}", runs.of_kept_default[k].total),
         percent(runs.of_kept_default[k].relative)});
  t.notes.push_back(fmt::format(
      "Sums of |decoded - K| over all entries and channels, and over the sum of K. K: five bounces "
      "between {} patches of the Cornell box. By default: kept entries leave no zeros in their "
      "blocks, sums of rows are kept, columns are divided by their means, and the logarithms' "
      "range "
      "is fitted.",
      runs.patches));
  return t;
}

Table order_table(const PaperRuns& runs) {
  Table t = new_table("relight, figure 7: error against the order",
                      {"reordered", "average, paper", "largest, paper", "total, paper", "average",
                       "largest", "total", "of all", "total, patches shuffled first", "of all"});
  for (size_t k = 0; k < 3; ++k) {
    const EntryError &e = runs.of_order[k], &s = runs.of_order_shuffled[k];
    t.rows.push_back({kOrders[k], fmt::format("{:.2e}", kPaperErrors[k][0]),
                      fmt::format("{:.4f}", kPaperErrors[k][1]),
                      fmt::format("{:.2f}", kPaperErrors[k][2]), fmt::format("{:.2e}", e.mean),
                      fmt::format("{:.4f}", e.largest), fmt::format("{:.2f}", e.total),
                      percent(e.relative), fmt::format("{:.2f}", s.total), percent(s.relative)});
  }
  t.notes.push_back(
      "All as the paper says, 4 % kept. The scenes differ, so ratios are what compares. Our "
      "patches "
      "already lie in the order of a tree of places and directions, in which neighbours are alike; "
      "the last two columns start from patches in no order.");
  return t;
}

Table speed_table(const PaperRuns& runs) {
  Table t = new_table("relight, figure 11: milliseconds per update",
                      {"reflections", "F, float", "K, float", "K, bc1", "F / bc1"});
  const UpdateTimes& ms = runs.ms;
  for (size_t k = 0; k < ms.single.size(); ++k)
    t.rows.push_back({fmt::format("{}", k + 1), fmt::format("{:.2f}", ms.single[k]),
                      fmt::format("{:.2f}", ms.reflections), fmt::format("{:.2f}", ms.bc1),
                      fmt::format("{:.1f}", ms.single[k] / ms.bc1)});
  t.notes.push_back(fmt::format(
      "{} patches. F is multiplied once per reflection, K once for all (here of 5; its time does "
      "not depend on how many). The goal is 10 times for 5 reflections. Five products with F in "
      "half floats: {:.2f} ms; with the colour matrix F^c in floats: {:.2f} ms. To make K took "
      "{:.1f} "
      "s, bc1 of it {:.1f} s. Medians of 15, methods in turn, each run once just before it is "
      "timed.",
      runs.patches, ms.half, ms.colour, runs.reflections_s, runs.bc1_s));
  return t;
}

Table memory_table(const PaperRuns& runs) {
  Table t = new_table("relight, figure 12: memory", {"matrix", "MiB", "F in floats / this"});
  const auto row = [&](const char* name, uint64_t bytes) {
    t.rows.push_back(
        {name, mib(bytes), fmt::format("{:.2f}", double(runs.single_bytes) / double(bytes))});
  };
  row("F, float", runs.single_bytes);
  row("F, half", runs.half_bytes);
  row("F^c or K, float", runs.colour_bytes);
  row("K, bc1", runs.bc1_bytes);
  t.notes.push_back("The goal is 3 times less than F in floats.");
  return t;
}

Table light_table(const PaperRuns& runs) {
  Table t =
      new_table("relight: bc1's error of E", {"point light at", "as in the paper", "by default"});
  for (size_t k = 0; k < runs.light.size(); ++k)
    t.rows.push_back(
        {fmt::format("({:.2f}, {:.2f}, {:.2f})", runs.light[k].x, runs.light[k].y, runs.light[k].z),
         percent(runs.paper_error[k]), percent(runs.default_error[k])});
  t.notes.push_back(
      "Relative root mean square error of the irradiance after five bounces, weighted by area, all "
      "channels, against K in floats. The goal is 2 %.");
  return t;
}

export_::Series steps(const Histogram& h, double scale) {
  export_::Series s{"", {}, export_::Stroke::steps};
  for (size_t k = 0; k < h.share.size(); ++k)
    s.points.push_back({h.first + double(k) * h.step, scale * h.share[k]});
  return s;
}

PageFile histogram_file(const char* name, const char* title, const char* x_label,
                        const Histogram& h) {
  export_::Plot p;
  p.title = title, p.x_label = x_label, p.y_label = "% of entries";
  p.series = {steps(h, 100)};
  const double highest = *std::max_element(h.share.begin(), h.share.end());
  p.x_range = {{h.first, h.first + h.step * double(h.share.size())}};
  p.y_range = {{0, 110 * highest}};
  return svg_file(name, export_::svg(p));
}

PageFile kept_file(const PaperRuns& runs) {
  export_::Plot p;
  p.title = "Error against what is kept", p.x_label = "% of entries kept";
  p.y_label = "total error, % of the sum";
  export_::Series paper{"as in the paper", {}}, ours{"by default", {}};
  for (size_t k = 0; k < runs.kept.size(); ++k) {
    paper.points.push_back({100 * double(runs.kept[k]), 100 * runs.of_kept[k].relative});
    ours.points.push_back({100 * double(runs.kept[k]), 100 * runs.of_kept_default[k].relative});
  }
  p.series = {std::move(paper), std::move(ours)};
  p.y_range = {{0, 110 * std::max(runs.of_kept[0].relative, runs.of_kept_default[0].relative)}};
  return svg_file("kept.svg", export_::svg(p));
}

PageFile speed_file(const PaperRuns& runs) {
  export_::Plot p;
  p.title = "Time of an update", p.x_label = "reflections", p.y_label = "ms";
  export_::Series naive{"F, float", {}}, dense{"K, float", {}}, bc1{"K, bc1", {}};
  for (size_t k = 0; k < runs.ms.single.size(); ++k) {
    const auto x = double(k + 1);
    naive.points.push_back({x, runs.ms.single[k]});
    dense.points.push_back({x, runs.ms.reflections}), bc1.points.push_back({x, runs.ms.bc1});
  }
  p.y_range = {{0, 1.1 * std::max(runs.ms.single.back(), runs.ms.reflections)}};
  p.series = {std::move(naive), std::move(dense), std::move(bc1)};
  return svg_file("speed.svg", export_::svg(p));
}

std::vector<PageFile> plots_of(const PaperRuns& runs) {
  return {histogram_file("factors.svg", "Form factors of patches that see each other", "log10 F",
                         runs.factors),
          histogram_file("small-factors.svg", "Form factors below 0.005", "F", runs.small_factors),
          kept_file(runs),
          histogram_file("logarithms.svg", "The rest of K, over its maximum", "logarithm",
                         runs.logarithms),
          histogram_file("bytes.svg", "The rest of K in 8 bits", "byte", runs.bytes),
          speed_file(runs)};
}

nlohmann::json json_of(const EntryError& e) {
  return {{"mean", e.mean}, {"largest", e.largest}, {"total", e.total}, {"relative", e.relative}};
}

nlohmann::json json_of(const PaperRuns& runs) {
  nlohmann::json out{
      {"patches", runs.patches},
      {"factors_below_0.005", runs.below},
      {"make_reflections_s", runs.reflections_s},
      {"make_bc1_s", runs.bc1_s},
      {"ms",
       {{"f_float", runs.ms.single},
        {"f_half_5", runs.ms.half},
        {"f_colour_5", runs.ms.colour},
        {"k_float", runs.ms.reflections},
        {"k_bc1", runs.ms.bc1}}},
      {"bytes",
       {{"f_float", runs.single_bytes},
        {"f_half", runs.half_bytes},
        {"k_float", runs.colour_bytes},
        {"k_bc1", runs.bc1_bytes}}},
      {"relit_error", {{"paper", runs.paper_error}, {"default", runs.default_error}}}};
  for (size_t k = 0; k < runs.kept.size(); ++k)
    out["kept"].push_back({{"share", runs.kept[k]},
                           {"paper", json_of(runs.of_kept[k])},
                           {"default", json_of(runs.of_kept_default[k])}});
  for (size_t k = 0; k < 3; ++k)
    out["order"].push_back({{"order", kOrders[k]},
                            {"tree", json_of(runs.of_order[k])},
                            {"shuffled", json_of(runs.of_order_shuffled[k])}});
  return out;
}

/// The share of a histogram's cells from `low` to `high`.
double between(const Histogram& h, double low, double high) {
  double sum = 0;
  for (size_t k = 0; k < h.share.size(); ++k) {
    const double middle = h.first + (double(k) + 0.5) * h.step;
    if (middle >= low && middle < high) sum += h.share[k];
  }
  return sum;
}

Table distribution_table(const PaperRuns& runs) {
  Table t = new_table("relight, figures 1, 3, 4: how entries are distributed",
                      {"entries", "range", "share"});
  t.rows.push_back({"F", "below 0.005", percent(runs.below)});
  for (const double low : {-25.0, -12.0, -9.0, -6.0, -3.0}) {
    const double high = low == -25 ? -12 : low + 3;
    t.rows.push_back({"logarithms of the rest of K", fmt::format("{:.0f} to {:.0f}", low, high),
                      percent(between(runs.logarithms, low, high))});
  }
  t.rows.push_back({"", "below -25", percent(between(runs.logarithms, -100, -25))});
  t.rows.push_back(
      {"bytes of the rest of K", "128 and above", percent(between(runs.bytes, 128, 256))});
  t.notes.push_back("The paper's figures 1, 3 and 4 as numbers; the plots show them whole.");
  return t;
}

}  // namespace

Result<PaperTables> measure_paper(size_t patches, Progress& progress) {
  LUXEL_TRY(const PaperRuns runs, run_paper(patches, progress));
  PaperTables out;
  out.tables = {distribution_table(runs), kept_table(runs),   order_table(runs),
                speed_table(runs),        memory_table(runs), light_table(runs)};
  out.pictures = plots_of(runs);
  out.json = json_of(runs);
  return out;
}

}  // namespace luxel::bench
