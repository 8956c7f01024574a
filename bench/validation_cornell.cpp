// The Cornell box: gather against the path tracer, as in [Moreno05, chapter 5] and beyond.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "bench/validation.h"
#include "luxel/base/random.h"
#include "luxel/display/draw.h"
#include "luxel/display/tone_map.h"
#include "luxel/export/plot.h"
#include "luxel/image/display_measures.h"
#include "luxel/image/false_color.h"
#include "luxel/post/dilate.h"
#include "luxel/scene/procedural.h"
#include "luxel/transport/irradiance_field.h"
#include "luxel/validate/agreement.h"

namespace luxel::bench {
namespace {

constexpr int kDirect = 200;  ///< shadow rays of the paper

pipeline::BakeSettings with_samples(int samples, uint64_t seed = 1) {
  pipeline::BakeSettings settings;
  settings.samples = samples;
  settings.direct_samples = kDirect;
  settings.seed = seed;
  return settings;
}

// ------------------------------------------------------------- error against samples and seconds

struct Curve {
  std::string solver;
  std::vector<std::array<double, 2>> by_samples, by_seconds;
};

Result<Curve> measure_curve(const validate::Prepared& p, const validate::Judged& judged,
                            std::string_view solver, const std::vector<int>& samples,
                            std::vector<std::vector<std::string>>& rows, Progress& progress) {
  Curve curve{std::string(solver), {}, {}};
  for (const int n : samples) {
    LUXEL_TRY(const validate::Timed solved,
              validate::solve(p, solver, with_samples(n, 5), progress));
    const validate::Agreement a =
        validate::agreement(solved.light.irradiance, solved.light.hidden, judged);
    rows.push_back(
        {std::string(solver), std::to_string(n), fmt::format("{:.2f}", solved.processor_seconds),
         validate::relative_rmse_text(a), fmt::format("{:+.3f} %", 100 * a.bias_over_mean)});
    curve.by_samples.push_back({double(n), a.relative_rmse});
    curve.by_seconds.push_back({solved.processor_seconds, a.relative_rmse});
  }
  return curve;
}

export_::Plot error_plot(const std::string& title, const std::string& x_label) {
  export_::Plot plot;
  plot.title = title;
  plot.x_label = x_label;
  plot.y_label = "relative RMSE";
  plot.log_x = plot.log_y = true;
  return plot;
}

Status convergence(Section& section, Progress& progress) {
  constexpr int kResolution = 128, kPaths = 1024;
  LUXEL_TRY(const auto p, validate::prepare(scene::cornell_box(), kResolution, progress));
  LUXEL_TRY(const validate::Judged judged, validate::judge(*p, kPaths, 1, progress));
  // Each solver with more and more samples.
  std::vector<std::vector<std::string>> rows;
  export_::Plot samples = error_plot("Cornell box: error against samples", "samples per texel");
  export_::Plot seconds = error_plot("Cornell box: error against time", "processor seconds");
  for (const auto& [solver, steps] : {std::pair{"gather", std::vector{64, 256, 1024, 4096}},
                                      std::pair{"reference", std::vector{64, 256, 1024}}}) {
    LUXEL_TRY(const Curve curve, measure_curve(*p, judged, solver, steps, rows, progress));
    samples.series.push_back({solver, curve.by_samples});
    seconds.series.push_back({solver, curve.by_seconds});
  }
  // Two plots and their table.
  section.files.push_back(svg_file("error-samples.svg", export_::svg(samples)));
  section.files.push_back(svg_file("error-seconds.svg", export_::svg(seconds)));
  section.markdown += fmt::format(
      "### Error against samples and processor seconds\n\n"
      "{0} x {0} texels, {1} shadow rays. The judge is two runs of {2} paths per texel, "
      "independent of the row \"reference\".\n\n"
      "{3}\n"
      "{4}\n"
      "{5}\n\n",
      kResolution, kDirect, kPaths,
      markdown_table({"solver", "samples", "processor s", "relative RMSE", "bias"}, rows),
      show(section.files[0], "Error against samples"),
      show(section.files[1], "Error against processor seconds"));
  return {};
}

// --------------------------------------------------------------- every texel of the paper's
// setting

/// Steps of 255 between what a screen shows of two irradiances, the largest of the channels.
struct Screen {
  float exposure = 1;

  std::array<float, 3> shown(Rgb e) const {
    image::Image pixel(1, 1, 4);
    pixel.data = {e.x, e.y, e.z, 1};
    const image::Image8 out = display::tone_map(pixel, exposure);
    return {float(out.data[0]), float(out.data[1]), float(out.data[2])};
  }
  float steps(Rgb a, Rgb b) const {
    const auto x = shown(a), y = shown(b);
    return std::max({std::abs(x[0] - y[0]), std::abs(x[1] - y[1]), std::abs(x[2] - y[2])});
  }
};

/// A texel passes when its difference from the judge and three of the judge's standard errors are
/// together below this many steps; else it is judged again with more paths.
constexpr float kMostSteps = 10;
/// The most paths that a texel is judged with, a power of two.
constexpr int kMostPaths = 1 << 17;

struct Round {
  int paths = 0;      ///< per texel
  size_t texels = 0;  ///< that were judged with so many
  size_t passed = 0;
  float largest = 0;  ///< difference of those that passed
};

Result<reference::TexelPaths> judge_texels(const validate::Prepared& p,
                                           std::span<const uint32_t> texels, int paths,
                                           uint64_t seed, Progress& progress) {
  std::vector<Vec3> position, normal, geometric;
  for (const uint32_t i : texels) {
    position.push_back(p.elements.position[i]);
    normal.push_back(p.elements.normal[i]);
    geometric.push_back(p.elements.geometric_normal[i]);
  }
  return reference::irradiance_by_paths(p.scene, {position, normal, geometric}, *p.tracer,
                                        {.samples = paths, .seed = seed}, progress);
}

/// Estimate of a texel's light: the mean of all its paths and its standard error.
struct Known {
  Rgb mean, standard_error;
  int paths = 0;

  void add(Rgb new_mean, Rgb new_error, int new_paths) {
    const auto n = float(paths), m = float(new_paths), all = n + m;
    mean = (mean * n + new_mean * m) / all;
    const auto joined = [&](float e, float f) { return std::hypot(e * n, f * m) / all; };
    standard_error = {joined(standard_error.x, new_error.x), joined(standard_error.y, new_error.y),
                      joined(standard_error.z, new_error.z)};
    paths += new_paths;
  }
};

/// Paths after which a texel's noise [steps] leaves room for a difference of some steps; in powers
/// of the square root of two, so that many texels share a number.
int paths_for(float noise, int paths) {
  constexpr float kNoise = 0.75f * kMostSteps;
  const float wanted =
      std::max(1.4f * float(paths), float(paths) * (noise / kNoise) * (noise / kNoise));
  const float steps = std::ceil(2 * std::log2(std::min(wanted, float(kMostPaths))));
  return std::min(kMostPaths, int(std::lround(std::exp2(steps / 2))));
}

/// Judges until all texels pass or have had kMostPaths; those are `left`. What made a texel fail
/// stays in its mean, so that it does not pass by chance sooner than one with new paths alone.
Result<std::vector<Round>> judge_again(const validate::Prepared& p, std::span<const Rgb> solved,
                                       const Screen& screen, const validate::Judged& first,
                                       int first_paths, std::vector<uint32_t>& left,
                                       Progress& progress) {
  std::vector<Known> known(solved.size());
  std::map<int, Round> rounds;  // by the paths that texels have had
  std::map<std::pair<int, int>, std::vector<uint32_t>> waiting;  // by those wanted and those had
  left.clear();
  const auto sort_out = [&](uint32_t i) {
    const Known& k = known[i];
    const float steps = screen.steps(solved[i], k.mean);
    const float noise = screen.steps(k.mean, k.mean + 3 * k.standard_error);
    Round& round = rounds[k.paths];
    round.paths = k.paths, ++round.texels;
    if (steps + noise < kMostSteps)
      ++round.passed, round.largest = std::max(round.largest, steps);
    else if (k.paths >= kMostPaths)
      left.push_back(i);
    else
      waiting[{paths_for(noise, k.paths), k.paths}].push_back(i);
  };
  // All texels by the judge's first answer.
  for (uint32_t i = 0; i < solved.size(); ++i) {
    if (first.hidden[i]) continue;
    known[i] = {first.mean(i), first.standard_error[i], first_paths};
    sort_out(i);
  }
  // More paths for those that wait, the fewest first.
  while (!waiting.empty()) {
    const auto [paths, chosen] = *waiting.begin();
    waiting.erase(waiting.begin());
    const int more = paths.first - paths.second;
    LUXEL_TRY(const reference::TexelPaths judged,
              judge_texels(p, chosen, more, hash64(uint64_t(paths.first), uint64_t(paths.second)),
                           progress));
    for (size_t k = 0; k < chosen.size(); ++k) {
      known[chosen[k]].add(judged.irradiance[k], judged.standard_error[k], more);
      sort_out(chosen[k]);
    }
  }
  std::vector<Round> out;
  for (const auto& [paths, round] : rounds) out.push_back(round);
  return out;
}

image::Image lightmap(const validate::Prepared& p, std::span<const Rgb> irradiance) {
  return post::lightmap_from_texels(p.map, irradiance);
}

Status every_texel(const validate::Prepared& p, const validate::Timed& solved, Section& section,
                   Progress& progress) {
  constexpr int kPaths = 64;
  LUXEL_TRY(const validate::Judged judged, validate::judge(p, kPaths, 2, progress));
  std::vector<Rgb> truth;
  for (size_t i = 0; i < judged.first.size(); ++i) truth.push_back(judged.mean(i));
  const Screen screen{display::auto_exposure(lightmap(p, truth))};
  std::vector<uint32_t> left;
  LUXEL_TRY(const std::vector<Round> rounds,
            judge_again(p, solved.light.irradiance, screen, judged, 2 * kPaths, left, progress));
  const validate::Agreement a =
      validate::agreement(solved.light.irradiance, solved.light.hidden, judged);
  // Texels that do not pass: those that count, and slivers.
  const auto is_covered = [&](uint32_t i) { return p.map.texels[i].centre_covered; };
  const auto off = std::count_if(left.begin(), left.end(), is_covered);
  size_t covered = 0;
  for (uint32_t i = 0; i < p.map.texels.size(); ++i) covered += is_covered(i) && !judged.hidden[i];
  std::vector<std::vector<std::string>> rows;
  for (const Round& r : rounds)
    rows.push_back({std::to_string(r.paths), std::to_string(r.texels), std::to_string(r.passed),
                    fmt::format("{:.0f}", r.largest)});
  section.markdown += fmt::format(
      "### Every texel\n\n"
      "The paper's setting is 512 x 512 texels with 200 direct and 2000 indirect samples "
      "([Moreno05, section 5.1]). gather took {:.0f} processor seconds. Both irradiances are tone "
      "mapped with one exposure. A texel passes when its difference from the path tracer plus "
      "three of the path tracer's standard errors is below {:.0f} of 255. The other texels get "
      "more paths, which join the earlier ones:\n\n"
      "{}\n"
      "Covered texels (alpha 1: their centre lies on a surface) that do not pass: **{}** of {}. "
      "The paper has 0.2 % of its pixels above 40. {} texels are only touched by a surface, so "
      "their sample is a sliver at its edge; of these, {} do not pass. Over all texels, without "
      "the judge's noise, the relative RMSE is **{:.2f} %** and the bias {:+.3f} %.\n\n",
      solved.processor_seconds, kMostSteps,
      markdown_table({"paths each", "texels judged", "passed", "their largest difference"}, rows),
      off, covered, a.texels - covered, ptrdiff_t(left.size()) - off, 100 * a.relative_rmse,
      100 * a.bias_over_mean);
  section.json["covered_texels_above_10"] = off;
  section.json["texels_above_10"] = left.size();
  section.json["relative_rmse"] = a.relative_rmse;
  section.json["bias_over_mean"] = a.bias_over_mean;
  return {};
}

// ------------------------------------------------------------------ the pictures of figures 5.1
// to 5.5

struct Shown {
  image::Image8 picture;
  std::vector<uint8_t> brightness;
};

Shown shown(const image::Image& radiance, float exposure) {
  Shown s{display::tone_map(radiance, exposure), {}};
  s.brightness = image::brightness(s.picture);
  return s;
}

export_::Series histogram_series(const std::string& name, const image::Histogram& counts) {
  export_::Series series{name, {}, export_::Stroke::steps};
  for (size_t v = 0; v < counts.size(); ++v)
    series.points.push_back({double(v), double(counts[v])});
  return series;
}

void show_pictures(const Shown& ours, const Shown& judge, const image::Mask& all, int width,
                   Section& section) {
  // The pictures, and their contours.
  std::vector<PageFile> files{png_file("gather.png", ours.picture),
                              png_file("paths.png", judge.picture)};
  for (const auto& [name, s] :
       {std::pair{"contours-gather.png", &ours}, std::pair{"contours-paths.png", &judge}}) {
    const auto lines = image::contours(s->brightness, width, all, image::kContourLevels);
    files.push_back(png_file(name, image::draw_contours(lines, s->brightness, width, all,
                                                        image::kContourLevels.size())));
  }
  // Pixels that differ by more than each level.
  const auto differences = image::pixel_differences(ours.picture, judge.picture);
  const image::Histogram counts = image::histogram(differences, all);
  std::string shares;
  for (const uint8_t level : image::kDifferenceLevels) {
    files.push_back(png_file(fmt::format("above-{}.png", level),
                             image::draw_threshold(differences, width, all, level)));
    const double share = image::share_above(counts, level);
    shares += fmt::format("{}{:.3f} % above {}", shares.empty() ? "" : ", ", 100 * share, level);
    section.json[fmt::format("pixels_above_{}", level)] = share;
  }
  // Histograms of both.
  export_::Plot plot;
  plot.title = "Brightness of the two pictures";
  plot.x_label = "brightness";
  plot.y_label = "pixels";
  plot.series = {histogram_series("gather", image::histogram(ours.brightness, all)),
                 histogram_series("path tracer", image::histogram(judge.brightness, all))};
  files.push_back(svg_file("histogram.svg", export_::svg(plot)));
  section.markdown += fmt::format(
      "### The paper's figures\n\n"
      "The box through its camera, drawn from gather's lightmap (left) and path traced (right), as "
      "in figure 5.1:\n\n"
      "{} {}\n\n"
      "Contours of brightness 40, 70, 90, 120, 140 (figure 5.2):\n\n"
      "{} {}\n\n"
      "Histograms of brightness (figure 5.3):\n\n"
      "{}\n\n"
      "The last three pictures show in black the pixels that differ by more than 10, 25 and 40 of "
      "255 (figures 5.4 and 5.5): {}. The paper had less than 4 % and 0.2 % above 40.\n\n"
      "{} {} {}\n",
      show(files[0], "gather"), show(files[1], "path tracer"), show(files[2], "contours, gather"),
      show(files[3], "contours, path tracer"), show(files[7], "histograms"), shares,
      show(files[4], "above 10"), show(files[5], "above 25"), show(files[6], "above 40"));
  for (PageFile& file : files) section.files.push_back(std::move(file));
}

Status pictures(const validate::Prepared& p, const validate::Timed& solved, Section& section,
                Progress& progress) {
  constexpr int kSide = 320, kPaths = 400, kRaysPerAxis = 8;
  const scene::Camera& camera = p.scene.cameras.front();
  const transport::TexelField field{&p.atlas, &p.map, solved.light.irradiance};
  LUXEL_TRY(const image::Image ours,
            display::draw(
                p.scene, *p.tracer, camera,
                [&](const scene::SurfacePoint& at) { return transport::irradiance_at(field, at); },
                {kSide, kSide, kRaysPerAxis}, progress));
  LUXEL_TRY(const reference::Picture judge,
            reference::radiance_by_paths(p.scene, *p.tracer, camera, kSide, kSide,
                                         {.samples = kPaths, .seed = 3}, progress));
  const float exposure = display::auto_exposure(judge.radiance);
  const image::Mask all(size_t(kSide) * kSide, 1);
  show_pictures(shown(ours, exposure), shown(judge.radiance, exposure), all, kSide, section);
  return {};
}

}  // namespace

Result<Section> validate_cornell_box(Progress& progress) {
  Section section;
  section.json = nlohmann::json::object();
  section.markdown = "## The Cornell box\n\n";
  LUXEL_TRY_STATUS(convergence(section, progress));
  LUXEL_TRY(const auto p, validate::prepare(scene::cornell_box(), 512, progress));
  LUXEL_TRY(const validate::Timed solved,
            validate::solve(*p, "gather", with_samples(2000), progress));
  LUXEL_TRY_STATUS(every_texel(*p, solved, section, progress));
  LUXEL_TRY_STATUS(pictures(*p, solved, section, progress));
  return section;
}

}  // namespace luxel::bench
