// The tables and plots of luxel bench relight.

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "bench/relight.h"
#include "luxel/base/parallel.h"
#include "luxel/export/plot.h"

namespace luxel::bench {
namespace {

std::string megabytes(uint64_t bytes) { return fmt::format("{:.2f}", 1e-6 * double(bytes)); }

Table codecs_table(const CodecRuns& runs) {
  Table t = new_table("relight: codecs",
                      {"codec", "setting", "MB", "ms per update", "error", "smaller than K",
                       "faster than K", "products of F^c", "faster than those", "made in, s"});
  for (const CodecRun& r : runs.runs)
    t.rows.push_back({r.codec, r.setting, megabytes(r.bytes), fmt::format("{:.2f}", r.ms),
                      percent(r.error), fmt::format("{:.1f}", runs.smaller(r)),
                      fmt::format("{:.1f}", runs.faster(r)), fmt::format("{}", r.products),
                      fmt::format("{:.1f}", runs.faster_than_iterated(r)),
                      fmt::format("{:.1f}", r.make_s)});
  t.notes.push_back(fmt::format(
      "{} patches of the Cornell box, {} rays each, infinite bounces. Error: relative root mean "
      "square of the irradiance, by area, of eight lamps in the open, against the converged\n"
      "iteration with the factors themselves. An update goes from what patches send to the "
      "irradiance of all bounces; medians of nine, codecs in turn, each run once just before it is "
      "timed.",
      runs.patches, runs.rays));
  t.notes.push_back(fmt::format(
      "The yardstick is the dense matrix of floats with three channels: {} MB, {:.1f} ms per "
      "product. K holds all bounces: one product per update. F^c holds one: `products` of it, "
      "plainly\niterated, err by no more than the codec. The goals are 40 times smaller and 30 "
      "times faster at an error below 1 %. Time to make a codec is from the factors; that of low "
      "ranks\nholds the spectrum of all, that of bc1 all bounces as a dense matrix.",
      megabytes(runs.colour_bytes), runs.colour_ms));
  return t;
}

Table sizes_table(const std::vector<SizeRun>& runs) {
  Table t = new_table("relight: sizes", {"patches", "rays per patch", "MB", "bytes per patch",
                                         "sweeps", "ms per update", "us per patch", "error"});
  for (const Stage& stage : runs.front().stages) t.columns.push_back(stage.name + ", s");
  for (const SizeRun& r : runs) {
    const double n = double(r.patches);
    t.rows.push_back({fmt::format("{}", r.patches), fmt::format("{}", r.rays), megabytes(r.bytes),
                      fmt::format("{:.0f}", double(r.bytes) / n), fmt::format("{}", r.sweeps),
                      fmt::format("{:.2f}", r.ms), fmt::format("{:.3f}", 1e3 * r.ms / n),
                      percent(r.error)});
    for (const Stage& stage : r.stages)
      t.rows.back().push_back(fmt::format("{:.1f}", stage.seconds));
  }
  t.notes.push_back(fmt::format(
      "The hierarchical codec of the Cornell box, block_error {} for all, infinite bounces, as "
      "many sweeps as leave less than 0.5 %. Error as above, of two lamps. The goals at 65,536 "
      "patches are 2 GB and 50 ms.",
      kSizesBlockError));
  return t;
}

double seconds_of(const std::vector<Stage>& stages) {
  double sum = 0;
  for (const Stage& stage : stages) sum += stage.seconds;
  return sum;
}

Table preparation_table(const std::vector<JudgedRelight>& judged) {
  Table t = new_table("relight: preparation", {"scene", "patches"});
  if (!judged.empty())
    for (const Stage& stage : judged.front().stages) t.columns.push_back(stage.name + ", s");
  t.columns.push_back("all, s");
  for (const JudgedRelight& j : judged) {
    t.rows.push_back({j.scene, fmt::format("{}", j.patches)});
    for (const Stage& stage : j.stages)
      t.rows.back().push_back(fmt::format("{:.1f}", stage.seconds));
    t.rows.back().push_back(fmt::format("{:.1f}", seconds_of(j.stages)));
  }
  t.notes.push_back(
      "From the scene to all that an .lxr file holds, hierarchical, --max-error 0.01, 8192 rays "
      "per patch. The goal is 60 s.");
  return t;
}

Table judged_table(const JudgedRelight& j) {
  Table t =
      new_table(fmt::format("relight against the path tracer: {}, {} patches", j.scene, j.patches),
                {"point light at", "relative RMSE", "point by point", "bias", "judge's noise"});
  double relative = 0, per_point = 0, squares = 0, point_squares = 0;
  for (const JudgedLight& l : j.lights) {
    t.rows.push_back(
        {fmt::format("({:.2f}, {:.2f}, {:.2f})", l.position.x, l.position.y, l.position.z),
         l.relative < l.resolution ? fmt::format("< {}", percent(l.resolution))
                                   : percent(l.relative),
         percent(l.per_point), fmt::format("{:+.2f} %", 100 * l.bias), percent(l.noise)});
    relative = std::max(relative, l.relative), per_point = std::max(per_point, l.per_point);
    squares += l.relative * l.relative / double(j.lights.size());
    point_squares += l.per_point * l.per_point / double(j.lights.size());
  }
  t.rows.push_back(
      {"root mean square", percent(std::sqrt(squares)), percent(std::sqrt(point_squares)), "", ""});
  t.rows.push_back({"largest", percent(relative), percent(per_point), "", ""});
  t.notes.push_back(fmt::format(
      "Indirect light at {} points spread evenly over the area, {} patches, "
      "infinite bounces, against {} paths per point. The codec loses {}, seldom more than {}. "
      "Relative RMSE: over the root mean square of the light. Point by point: of "
      "errors over\nthe light of their points. The judge's noise is taken out of both. The goal is "
      "5 %. Lamps stand at random in the air.",
      j.points, j.patches, j.paths, percent(j.codec_error), percent(j.largest_codec_error)));
  return t;
}

/// One series per codec, in the order in which they come.
PageFile pareto_file(const CodecRuns& runs, const char* name, const char* title,
                     const char* x_label, double (*x)(const CodecRun&)) {
  export_::Plot p;
  p.title = title, p.x_label = x_label, p.y_label = "error, %";
  p.log_x = p.log_y = true;
  for (const CodecRun& r : runs.runs) {
    if (p.series.empty() || p.series.back().name != r.codec) p.series.push_back({r.codec, {}});
    p.series.back().points.push_back({x(r), 100 * r.error});
  }
  return svg_file(name, export_::svg(p));
}

PageFile sizes_file(const std::vector<SizeRun>& runs, const char* name, const char* title,
                    const char* y_label, double (*y)(const SizeRun&)) {
  export_::Plot p;
  p.title = title, p.x_label = "patches", p.y_label = y_label;
  p.log_x = true;
  export_::Series s{"", {}};
  double highest = 0;
  for (const SizeRun& r : runs)
    s.points.push_back({double(r.patches), y(r)}), highest = std::max(highest, y(r));
  p.y_range = {{0, 1.1 * highest}};
  p.series = {std::move(s)};
  return svg_file(name, export_::svg(p));
}

std::vector<PageFile> plots_of(const CodecRuns& codecs, const std::vector<SizeRun>& sizes) {
  return {pareto_file(codecs, "error-bytes.svg", "Error against memory", "MB",
                      [](const CodecRun& r) { return 1e-6 * double(r.bytes); }),
          pareto_file(codecs, "error-ms.svg", "Error against time", "ms per update",
                      [](const CodecRun& r) { return r.ms; }),
          sizes_file(sizes, "sizes-bytes.svg", "Memory of the hierarchy", "bytes per patch",
                     [](const SizeRun& r) { return double(r.bytes) / double(r.patches); }),
          sizes_file(sizes, "sizes-ms.svg", "Time of an update", "microseconds per patch",
                     [](const SizeRun& r) { return 1e3 * r.ms / double(r.patches); })};
}

nlohmann::json json_of(const std::vector<Stage>& stages) {
  nlohmann::json out = nlohmann::json::object();
  for (const Stage& stage : stages) out[stage.name] = stage.seconds;
  return out;
}

void write_runs(const CodecRuns& codecs, const std::vector<SizeRun>& sizes, RelightPage& page) {
  page.csv = "test,codec,setting,patches,bytes,ms,error,products\n";
  const auto line = [&](const char* test, const CodecRun& r) {
    page.csv += fmt::format("{},{},{},{},{},{:.4f},{:.6f},{}\n", test, r.codec, r.setting,
                            r.patches, r.bytes, r.ms, r.error, r.products);
    page.json[test].push_back({{"codec", r.codec},
                               {"setting", r.setting},
                               {"patches", r.patches},
                               {"bytes", r.bytes},
                               {"ms", r.ms},
                               {"error", r.error},
                               {"make_s", r.make_s}});
  };
  for (const CodecRun& r : codecs.runs) line("codecs", r);
  line("codecs", {"K", "float", codecs.patches, codecs.colour_bytes, codecs.colour_ms, 0, 0, 1});
  for (const SizeRun& r : sizes) {
    line("sizes", {"hierarchical", fmt::format("block_error {}", kSizesBlockError), r.patches,
                   r.bytes, r.ms, r.error, 0, 0});
    page.json["sizes"].back()["stages_s"] = json_of(r.stages);
  }
}

nlohmann::json json_of(const JudgedRelight& j) {
  nlohmann::json out{{"scene", j.scene},
                     {"patches", j.patches},
                     {"points", j.points},
                     {"paths", j.paths},
                     {"codec_error", j.codec_error},
                     {"largest_codec_error", j.largest_codec_error},
                     {"stages_s", json_of(j.stages)}};
  for (const JudgedLight& l : j.lights)
    out["lights"].push_back({{"position", {l.position.x, l.position.y, l.position.z}},
                             {"relative_rmse", l.relative},
                             {"resolution", l.resolution},
                             {"point_by_point", l.per_point},
                             {"bias_over_mean", l.bias},
                             {"judge_noise", l.noise}});
  return out;
}

}  // namespace

void append(const JudgedScenes& judged, RelightPage& page) {
  page.tables.push_back(preparation_table(judged.runs));
  for (const JudgedRelight& j : judged.runs) page.tables.push_back(judged_table(j));
  for (const std::string& missing : judged.missing)
    page.tables.back().notes.push_back(
        fmt::format("shared/scenes/{} is not on this machine: left out", missing));
  for (const JudgedRelight& j : judged.runs) page.json["judged"].push_back(json_of(j));
}

RelightPage page_of(RelightRuns runs) {
  RelightPage page;
  page.tables = std::move(runs.paper.tables);
  page.tables.push_back(codecs_table(runs.codecs));
  page.tables.push_back(sizes_table(runs.sizes));
  for (PageFile& file : runs.paper.pictures)
    page.pictures.push_back({"paper-" + file.name, std::move(file.bytes)});
  for (PageFile& file : plots_of(runs.codecs, runs.sizes)) page.pictures.push_back(std::move(file));
  page.json["paper"] = std::move(runs.paper.json);
  write_runs(runs.codecs, runs.sizes, page);
  append(runs.judged, page);
  return page;
}

}  // namespace luxel::bench
