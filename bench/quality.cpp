// luxel bench quality: how far pictures of bakes of each quality look from one of a long bake, for
// the processor time that their light takes.
#include <cmath>
#include <ctime>
#include <memory>
#include <optional>

#include "bench/baked_picture.h"
#include "bench/bench.h"
#include "bench/timing.h"
#include "luxel/base/parallel.h"
#include "luxel/display/tone_map.h"
#include "luxel/pipeline/bake/denoise_light.h"
#include "luxel/pipeline/settings/quality.h"
#include "luxel/pipeline/texels/connected_texels.h"
#include "luxel/scene/procedural.h"

namespace luxel::bench {
namespace {

using pipeline::Quality;
using pipeline::QualityNumbers;

/// Small enough for twenty scenes in minutes, and as many pixels for a texel as in the preview of a
/// bake at the default density.
constexpr int kQualityResolution = 128, kQualityWidth = 240, kQualityHeight = 180;
/// Twice the rays of best, of another seed. Its own noise adds a fifth to the difference of best.
constexpr QualityNumbers kQualityTruth{2048, 256, 128, false};
constexpr uint64_t kQualityTruthSeed = 1000;

struct QualityScene {
  std::string_view file;  ///< below shared/scenes
  std::string_view view;  ///< --view
};
/// The camera of the lit tile room looks from its dark back at a gap of light: there the long bake
/// is noise, too. zdm2, pandora, kaykit_city and the garden are left out: their 4,649 to 17,335
/// charts need maps of 256 or 512 texels, which take longer than all others together.
constexpr std::array kQualityScenes{
    QualityScene{"cornell_box/cornell_box.glb", ""},
    QualityScene{"tile_game_room/tile_game_room6.glb", ""},
    QualityScene{"tile_game_room/tile_game_room_lit_uv1.glb", "interior"},
    QualityScene{"living_room/living_room.glb", ""},
    QualityScene{"living_room/living_room_lit_uv1.glb", ""},
    QualityScene{"suzanne_room/room.glb", ""},
    QualityScene{"spot_teapot_bunny/spot.obj", ""},
    QualityScene{"spot_teapot_bunny/teapot.obj", ""},
    QualityScene{"spot_teapot_bunny/stanford-bunny.obj", ""}};

/// A bake of these numbers gives two rows: as it was sampled, and denoised.
struct QualityRun {
  std::string_view name;
  QualityNumbers numbers;
};

std::vector<QualityRun> quality_runs() {
  const QualityNumbers good = pipeline::numbers_of(Quality::good);
  const auto [rays, shadow_rays, points, denoise] = good;
  return {{"draft", pipeline::numbers_of(Quality::draft)},
          {"good, half the rays", {rays / 2, shadow_rays, points, true}},
          {"good, half the shadow rays", {rays, shadow_rays / 2, points, true}},
          {"good, half the points", {rays, shadow_rays, points / 2, true}},
          {"good", good},
          {"good, twice the rays", {2 * rays, shadow_rays, points, true}},
          {"good, twice the shadow rays", {rays, 2 * shadow_rays, points, true}},
          {"good, twice the points", {rays, shadow_rays, 2 * points, true}},
          {"best", pipeline::numbers_of(Quality::best)}};
}

/// Rows that are of use: each run as it is meant, and both of draft, good and best.
bool is_shown(const QualityRun& run, bool denoised) {
  return denoised == run.numbers.denoise || run.name.find(',') == std::string_view::npos;
}

pipeline::BakeSettings settings_of(const QualityNumbers& numbers, int threads) {
  pipeline::BakeSettings s;
  s.output = std::filesystem::temp_directory_path(), s.threads = threads;
  s.resolution = kQualityResolution, s.samples = numbers.samples;
  s.direct_samples = numbers.direct_samples, s.supersample = numbers.supersample;
  return s;
}

display::DrawParams picture_size() {
  return {.width = kQualityWidth, .height = kQualityHeight, .samples_per_axis = 2};
}

/// Standard error of a part of the light over the mean light.
double noise_of(const pipeline::TexelLight& light, std::span<const float> variance) {
  double mean = 0, sum = 0;
  for (const Rgb& e : light.irradiance) mean += double(luminance(e));
  for (const float v : variance) sum += double(v);
  const double n = double(light.irradiance.size());
  return mean > 0 ? std::sqrt(sum / n) / (mean / n) : 0;
}

/// A setting in one scene, or the geometric mean over scenes.
struct QualityFigures {
  double seconds = 0, flip = 0, indirect = 0, direct = 0;
};

/// A scene as it is laid out, and what its camera sees after a long bake. Members refer to each
/// other: it is made in place and not moved.
struct QualityCase {
  pipeline::Bake bake;
  std::optional<trace::RayTracer> tracer;
  transport::Elements elements;
  light::Lights lights;
  image::Image reference;
  float exposure = 1;

  light::TexelScene input() const {
    return {bake.scene, bake.atlas, bake.map, elements, lights, *tracer};
  }
};

Result<std::unique_ptr<QualityCase>> quality_case(pipeline::Bake laid_out, int threads,
                                                  Progress& progress) {
  auto c = std::make_unique<QualityCase>();
  c->bake = std::move(laid_out);
  LUXEL_TRY(trace::RayTracer tracer, trace::RayTracer::build(c->bake.scene));
  c->tracer.emplace(std::move(tracer));
  c->elements = transport::elements_from_texels(c->bake.scene, c->bake.atlas, c->bake.map);
  c->lights = light::collect_lights(c->bake.scene);
  pipeline::BakeSettings settings = settings_of(kQualityTruth, threads);
  settings.seed = kQualityTruthSeed;
  LUXEL_TRY(const pipeline::TexelLight truth,
            pipeline::find_solver("gather")->solve(c->input(), settings, {}, {}, progress));
  LUXEL_TRY(const image::Image radiance, draw_baked(c->bake, *c->tracer, c->bake.view.camera,
                                                    truth.irradiance, picture_size(), progress));
  c->exposure = display::readable_exposure(radiance);
  c->reference = on_screen(radiance, c->exposure);
  return c;
}

/// Both rows of a run: as it was sampled, and, where it is of use, denoised.
Result<std::array<QualityFigures, 2>> measure_run(const QualityCase& c, const QualityRun& run,
                                                  int threads, Progress& progress) {
  const pipeline::BakeSettings settings = settings_of(run.numbers, threads);
  std::clock_t start = std::clock();
  LUXEL_TRY(pipeline::TexelLight light,
            pipeline::find_solver("gather")->solve(c.input(), settings, {}, {}, progress));
  double seconds = processor_seconds_since(start);
  const double indirect = noise_of(light, light.variance);
  const double direct = noise_of(light, light.direct_variance);
  std::array<QualityFigures, 2> out;
  for (const bool denoised : {false, true}) {
    if (denoised) {
      start = std::clock();
      const light::TexelScene in = c.input();
      LUXEL_TRY(const std::vector<uint32_t> regions,
                pipeline::connected_texels(in, light.hidden, progress));
      LUXEL_TRY_STATUS(pipeline::denoise_light(in, settings, regions, light, progress));
      seconds += processor_seconds_since(start);
    }
    if (!is_shown(run, denoised)) continue;
    LUXEL_TRY(const image::Image radiance, draw_baked(c.bake, *c.tracer, c.bake.view.camera,
                                                      light.irradiance, picture_size(), progress));
    out[size_t(denoised)] = {seconds, mean_flip(on_screen(radiance, c.exposure), c.reference),
                             indirect, direct};
  }
  return out;
}

/// Figures of all scenes by the name of the setting, in the order of the runs.
struct QualityTable {
  std::vector<std::string> scenes, settings;
  std::vector<QualityNumbers> numbers;                ///< per setting
  std::vector<std::vector<QualityFigures>> by_scene;  ///< per scene and setting
};

std::string name_of_row(const QualityRun& run, bool denoised) {
  if (denoised == run.numbers.denoise) return std::string(run.name);
  return fmt::format("{}, --{}denoise", run.name, denoised ? "" : "no-");
}

Status measure_case(const std::string& name, pipeline::Bake laid_out, int threads,
                    QualityTable& table) {
  Progress progress;
  LUXEL_TRY(const auto c, quality_case(std::move(laid_out), threads, progress));
  table.scenes.push_back(name), table.settings.clear(), table.numbers.clear();
  std::vector<QualityFigures>& row = table.by_scene.emplace_back();
  for (const QualityRun& run : quality_runs()) {
    LUXEL_TRY(const auto both, measure_run(*c, run, threads, progress));
    for (const bool denoised : {false, true}) {
      if (!is_shown(run, denoised)) continue;
      row.push_back(both[size_t(denoised)]);
      table.settings.push_back(name_of_row(run, denoised)), table.numbers.push_back(run.numbers);
    }
  }
  return {};
}

/// A bake of which only layout and camera count.
pipeline::BakeSettings layout_settings(int threads) { return settings_of({1, 1, 1}, threads); }

Status measure_shared(const std::filesystem::path& shared, int threads, QualityTable& table) {
  for (const QualityScene& scene : kQualityScenes) {
    pipeline::BakeSettings settings = layout_settings(threads);
    settings.scene = shared / "scenes" / scene.file, settings.view = scene.view;
    if (!std::filesystem::exists(settings.scene)) continue;
    Progress progress;
    LUXEL_TRY(pipeline::Bake laid_out, pipeline::bake_scene(settings, progress));
    LUXEL_TRY_STATUS(
        measure_case(settings.scene.stem().string(), std::move(laid_out), threads, table));
  }
  return {};
}

/// Scenes of our own but those that others hold: the Cornell box is among the shared ones, and in
/// a furnace every texel has the same light.
Status measure_own_scenes(int threads, QualityTable& table) {
  for (scene::NamedScene& own : scene::procedural_scenes()) {
    if (own.file.starts_with("cornell") || own.file.starts_with("furnace")) continue;
    Progress progress;
    LUXEL_TRY(pipeline::Bake laid_out,
              pipeline::bake_scene(std::move(own.scene), layout_settings(threads), progress));
    LUXEL_TRY_STATUS(measure_case(std::filesystem::path(own.file).stem().string(),
                                  std::move(laid_out), threads, table));
  }
  return {};
}

QualityFigures geometric_mean(const QualityTable& table, size_t setting) {
  QualityFigures sum;
  for (const auto& row : table.by_scene) {
    sum.seconds += std::log(row[setting].seconds), sum.flip += std::log(row[setting].flip);
    // Noise may be none at all, as direct light's of a scene with one point light.
    sum.indirect += row[setting].indirect, sum.direct += row[setting].direct;
  }
  const double n = double(table.by_scene.size());
  return {std::exp(sum.seconds / n), std::exp(sum.flip / n), sum.indirect / n, sum.direct / n};
}

std::string numbers_text(const QualityNumbers& n) {
  return fmt::format("{} / {} / {}", n.samples, n.direct_samples, n.supersample);
}

/// The table's own rows are means over scenes, each of its notes' rows is a scene.
Table printed(const QualityTable& measured) {
  Table table = new_table("quality", {"setting", "rays / shadow rays / points", "processor s",
                                      "FLIP", "noise of indirect light", "noise of direct light"});
  std::string scenes = "| scene |", rules = "| --- |";
  std::vector<size_t> shown;
  for (size_t k = 0; k < measured.settings.size(); ++k) {
    const QualityFigures f = geometric_mean(measured, k);
    table.rows.push_back({measured.settings[k], numbers_text(measured.numbers[k]),
                          fmt::format("{:.2f}", f.seconds), fmt::format("{:.4f}", f.flip),
                          percent(f.indirect), percent(f.direct)});
    if (measured.settings[k].find(", half") != std::string::npos ||
        measured.settings[k].find(", twice") != std::string::npos)
      continue;
    shown.push_back(k);
    scenes += fmt::format(" {}: s | FLIP |", measured.settings[k]), rules += " --- | --- |";
  }
  scenes += "\n" + rules;
  for (size_t i = 0; i < measured.scenes.size(); ++i) {
    scenes += fmt::format("\n| {} |", measured.scenes[i]);
    for (const size_t k : shown) {
      const QualityFigures& f = measured.by_scene[i][k];
      scenes += fmt::format(" {:.2f} | {:.4f} |", f.seconds, f.flip);
    }
    for (size_t k = 0; k < measured.settings.size(); ++k) {
      const QualityFigures& f = measured.by_scene[i][k];
      table.json.push_back({{"scene", measured.scenes[i]},
                            {"setting", measured.settings[k]},
                            {"samples", measured.numbers[k].samples},
                            {"direct_samples", measured.numbers[k].direct_samples},
                            {"supersample", measured.numbers[k].supersample},
                            {"processor_s", f.seconds},
                            {"flip", f.flip},
                            {"indirect_noise", f.indirect},
                            {"direct_noise", f.direct}});
    }
  }
  table.notes.push_back(scenes);
  table.notes.push_back(fmt::format(
      "{0} x {0} texels, {1} scenes: geometric means of processor seconds of the light and of FLIP "
      "over {2} x {3} pixels, against a bake of {4} rays, {5} shadow rays and {6} points; means of "
      "noise, which is before the denoiser and over the mean light.",
      kQualityResolution, measured.scenes.size(), kQualityWidth, kQualityHeight,
      kQualityTruth.samples, kQualityTruth.direct_samples, kQualityTruth.supersample));
  return table;
}

}  // namespace

Result<Table> measure_quality(const std::filesystem::path& shared, int threads) {
  const ThreadLimit limit(threads);
  QualityTable measured;
  LUXEL_TRY_STATUS(measure_shared(shared, threads, measured));
  LUXEL_TRY_STATUS(measure_own_scenes(threads, measured));
  return printed(measured);
}

}  // namespace luxel::bench
