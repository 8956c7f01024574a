// luxel bench denoise: what --denoise takes away of the error, and what it adds to light that has
// none.
#include <ctime>

#include "bench/bench.h"
#include "bench/timing.h"
#include "luxel/base/parallel.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/bake/denoise_light.h"
#include "luxel/pipeline/texels/connected_texels.h"
#include "luxel/scene/procedural.h"
#include "luxel/validate/agreement.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {
namespace {

constexpr int kDenoiseResolution = 128;
/// The reference: this many bakes of this many samples, of other seeds; its own error is a third of
/// that of the last row.
constexpr int kReferenceBakes = 8, kReferenceSamples = 1024;
constexpr std::array kDenoiseSamples{16, 64, 256, 1024};

/// A quarter as many shadow rays as indirect ones, as in the defaults.
pipeline::BakeSettings settings_of(int samples, uint64_t seed) {
  pipeline::BakeSettings settings;
  settings.samples = samples;
  settings.direct_samples = samples / 4;
  settings.seed = seed;
  settings.supersample = 1;  // validate::solve() samples points
  return settings;
}

Result<std::vector<Rgb>> reference_of(const validate::Prepared& p, Progress& progress) {
  std::vector<Rgb> mean(p.elements.size());
  for (int k = 0; k < kReferenceBakes; ++k) {
    LUXEL_TRY(
        const validate::Timed bake,
        validate::solve(p, "gather", settings_of(kReferenceSamples, uint64_t(1000 + k)), progress));
    for (size_t i = 0; i < mean.size(); ++i)
      mean[i] += bake.light.irradiance[i] / float(kReferenceBakes);
  }
  return mean;
}

Status measure(const std::string& name, scene::Scene scene, Table& table) {
  Progress progress;
  LUXEL_TRY(const auto p, validate::prepare(std::move(scene), kDenoiseResolution, progress));
  LUXEL_TRY(const std::vector<Rgb> reference, reference_of(*p, progress));
  for (const int samples : kDenoiseSamples) {
    const pipeline::BakeSettings settings = settings_of(samples, 1);
    std::clock_t start = std::clock();
    LUXEL_TRY(validate::Timed bake, validate::solve(*p, "gather", settings, progress));
    const validate::Errors before =
        validate::errors_of(bake.light.irradiance, reference, bake.light.hidden);
    // The filter, in place.
    const double light_s = processor_seconds_since(start);
    start = std::clock();
    LUXEL_TRY(const std::vector<uint32_t> regions,
              pipeline::connected_texels(p->input(), bake.light.hidden, progress));
    LUXEL_TRY_STATUS(pipeline::denoise_light(p->input(), settings, regions, bake.light, progress));
    const double seconds = processor_seconds_since(start);
    const validate::Errors after =
        validate::errors_of(bake.light.irradiance, reference, bake.light.hidden);
    const auto percent = [](double v) { return fmt::format("{:.3f} %", 100 * v); };
    table.rows.push_back(
        {name, fmt::format("{}", samples), percent(before.relative), percent(after.relative),
         fmt::format("{:.2f}", before.relative / after.relative), percent(before.over_mean),
         percent(after.over_mean), fmt::format("{:+.3f} %", 100 * (after.mean - before.mean)),
         fmt::format("{:.2f}", light_s), fmt::format("{:.2f}", seconds)});
    table.json.push_back({{"scene", name},
                          {"samples", samples},
                          {"relative_rmse", {before.relative, after.relative}},
                          {"rmse_over_mean", {before.over_mean, after.over_mean}},
                          {"mean_change", after.mean - before.mean},
                          {"light_processor_s", light_s},
                          {"denoise_processor_s", seconds}});
  }
  return {};
}

/// Seconds of the filter alone at 1024 x 1024.
Status measure_large(Table& table) {
  Progress progress;
  LUXEL_TRY(const auto p, validate::prepare(scene::cornell_box(), 1024, progress));
  const pipeline::BakeSettings settings = settings_of(64, 1);
  std::clock_t start = std::clock();
  LUXEL_TRY(validate::Timed bake, validate::solve(*p, "gather", settings, progress));
  const double light_s = processor_seconds_since(start);
  start = std::clock();
  LUXEL_TRY(const std::vector<uint32_t> regions,
            pipeline::connected_texels(p->input(), bake.light.hidden, progress));
  LUXEL_TRY_STATUS(pipeline::denoise_light(p->input(), settings, regions, bake.light, progress));
  const double seconds = processor_seconds_since(start);
  table.notes.push_back(
      fmt::format("The Cornell box at 1024 x 1024 ({} texels), 64 samples: {:.1f} processor "
                  "seconds for the light, {:.1f} to denoise it.",
                  p->elements.size(), light_s, seconds));
  table.json.push_back({{"scene", "Cornell box, 1024 x 1024"},
                        {"samples", 64},
                        {"light_processor_s", light_s},
                        {"denoise_processor_s", seconds}});
  return {};
}

}  // namespace

Result<Table> measure_denoise(const std::filesystem::path& shared, int threads) {
  const ThreadLimit limit(threads);
  Table table = new_table("denoise", {"scene", "samples", "relative RMSE", "denoised", "factor",
                                      "RMSE / mean", "denoised", "change of the mean",
                                      "light, processor s", "denoising, processor s"});
  LUXEL_TRY_STATUS(measure("Cornell box", scene::cornell_box(), table));
  const auto file = shared / "scenes/living_room/living_room_lit_uv1.glb";
  if (std::filesystem::exists(file)) {
    LUXEL_TRY(import::Imported imported, import::import_scene(file));
    LUXEL_TRY_STATUS(measure("living_room_lit_uv1", std::move(imported.scene), table));
  } else {
    table.notes.push_back(file.string() + " is not on this machine: left out");
  }
  table.notes.push_back(
      fmt::format("{0} x {0} texels, a quarter as many shadow rays as samples; "
                  "against the mean of {1} bakes of {2} samples.",
                  kDenoiseResolution, kReferenceBakes, kReferenceSamples));
  LUXEL_TRY_STATUS(measure_large(table));
  return table;
}

}  // namespace luxel::bench
