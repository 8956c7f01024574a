// luxel bench rms: whether bakes that are asked for a root mean square error have it.
#include <cmath>
#include <memory>

#include "bench/bench.h"
#include "luxel/base/parallel.h"
#include "luxel/import/import.h"
#include "luxel/scene/procedural.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {
namespace {

constexpr std::array kAskedErrors{0.04, 0.02, 0.01, 0.005};
/// Two bakes without a common random number judge: of 2,048 rays per texel each, or of so many in
/// all where maps are large. Their own noise does not count (true_rms), and is less than that of
/// the finest bake or about as much, so that thousands of texels tell its error to a few per cent.
constexpr int kMostJudgeSamples = 2048;
constexpr double kJudgeRays = 4e7;
constexpr uint64_t kFirstJudgeSeed = 1001;
/// Shadow rays and points of the judges, which are few where those of a bake may be many.
constexpr int kJudgeShadowRays = 256, kJudgePoints = 64;

struct SharedScene {
  std::string_view file;  ///< below shared/scenes
  int resolution;         ///< texels a side, enough for all charts
};
constexpr std::array kRmsScenes{
    SharedScene{"cornell_box/cornell_box.glb", 128},
    SharedScene{"tile_game_room/tile_game_room_lit_uv1.glb", 128},
    SharedScene{"living_room/living_room_lit_uv1.glb", 128},
    SharedScene{"suzanne_room/room.glb", 128},
    SharedScene{"spot_teapot_bunny/spot.obj", 128},
    SharedScene{"spot_teapot_bunny/teapot.obj", 128},
    SharedScene{"spot_teapot_bunny/stanford-bunny.obj", 128},
    SharedScene{"japanese_bridge_garden/japanese_bridge_garden.glb", 512},
    SharedScene{"kaykit_city/kaykit_city.glb", 512},
    SharedScene{"pandora/pandora.obj", 512},
    SharedScene{"zdm2/zdm2.glb", 512}};
constexpr std::array<std::string_view, 3> kOwnRmsScenes{"office.glb", "foliage.glb",
                                                        "tiled-kit.glb"};

Result<pipeline::TexelLight> gathered(const validate::Prepared& p,
                                      const pipeline::BakeSettings& settings) {
  Progress progress;
  return pipeline::find_solver("gather")->solve(p.input(), settings, {}, {}, progress);
}

/// Two bakes of the same scene.
struct Judges {
  pipeline::TexelLight first, second;
};
Result<Judges> judges_of(const validate::Prepared& p, pipeline::BakeSettings settings) {
  const double texels = double(std::max<size_t>(p.elements.size(), 1));
  settings.samples = 256;
  while (settings.samples < kMostJudgeSamples && 2 * settings.samples * texels <= kJudgeRays)
    settings.samples *= 2;
  settings.direct_samples = kJudgeShadowRays, settings.supersample = kJudgePoints;
  settings.seed = kFirstJudgeSeed;
  LUXEL_TRY(pipeline::TexelLight first, gathered(p, settings));
  settings.seed = kFirstJudgeSeed + 1;
  LUXEL_TRY(pipeline::TexelLight second, gathered(p, settings));
  return Judges{std::move(first), std::move(second)};
}

/// Over the mean light, without what the judges do not know: the mean of (x - a) (x - b) is the
/// squared error of x, for the noise of a is independent of that of b. Over texels that nobody
/// takes for the inside of a solid.
double true_rms(const pipeline::TexelLight& bake, const Judges& judges) {
  double sum2 = 0, mean = 0, count = 0;
  for (size_t i = 0; i < bake.irradiance.size(); ++i) {
    if (bake.hidden[i] || judges.first.hidden[i] || judges.second.hidden[i]) continue;
    const double x = double(luminance(bake.irradiance[i])),
                 a = double(luminance(judges.first.irradiance[i])),
                 b = double(luminance(judges.second.irradiance[i]));
    sum2 += (x - a) * (x - b), mean += 0.5 * (a + b), count += 1;
  }
  return mean > 0 ? std::sqrt(std::max(0.0, sum2) * count) / mean : 0;
}

Status measure_rms_of(const std::string& name, scene::Scene scene, int resolution, Table& table) {
  Progress progress;
  LUXEL_TRY(const auto p, validate::prepare(std::move(scene), resolution, progress));
  pipeline::BakeSettings settings;
  settings.output = std::filesystem::temp_directory_path(), settings.resolution = resolution;
  LUXEL_TRY(const Judges judges, judges_of(*p, settings));
  settings.error_measure = gather::ErrorMeasure::rms;
  for (const double asked : kAskedErrors) {
    settings.max_error = asked;
    LUXEL_TRY(const pipeline::TexelLight bake, gathered(*p, settings));
    const double truth = true_rms(bake, judges);
    table.rows.push_back(
        {name, fmt::format("{:.1f}", 100 * asked), fmt::format("{:.2f}", 100 * bake.relative_error),
         fmt::format("{:.2f}", 100 * truth), fmt::format("{:.2f}", truth / bake.relative_error),
         fmt::format("{:.1f}", double(bake.rays) * 1e-6)});
    table.json.push_back({{"scene", name},
                          {"asked", asked},
                          {"stated", bake.relative_error},
                          {"true", truth},
                          {"rays", bake.rays}});
  }
  return {};
}

}  // namespace

Result<Table> measure_rms(const std::filesystem::path& shared, int threads) {
  return measure_rms_in(shared, "", threads);
}

Result<Table> measure_rms_in(const std::filesystem::path& shared, const std::string& scene,
                             int threads) {
  const ThreadLimit limit(threads);
  Table table = new_table(
      "rms", {"scene", "asked [%]", "stated [%]", "true [%]", "true / stated", "rays [millions]"});
  bool is_known = scene.empty();
  const auto is_asked_for = [&](const std::filesystem::path& file) {
    is_known = is_known || file.stem() == scene;
    return scene.empty() || file.stem() == scene;
  };
  for (const SharedScene& in : kRmsScenes) {
    const std::filesystem::path file = shared / "scenes" / in.file;
    if (!is_asked_for(file)) continue;
    if (!std::filesystem::exists(file)) {
      table.notes.push_back(file.string() + " is not on this machine: left out");
      continue;
    }
    LUXEL_TRY(import::Imported imported, import::import_scene(file));
    LUXEL_TRY_STATUS(
        measure_rms_of(file.parent_path().filename().string() + "/" + file.stem().string(),
                       std::move(imported.scene), in.resolution, table));
  }
  for (scene::NamedScene& own : scene::procedural_scenes()) {
    const std::filesystem::path file(own.file);
    if (std::ranges::find(kOwnRmsScenes, own.file) == kOwnRmsScenes.end() || !is_asked_for(file))
      continue;
    LUXEL_TRY_STATUS(measure_rms_of(file.stem().string(), std::move(own.scene), 128, table));
  }
  if (!is_known)
    return fail(ErrorCode::bad_setting,
                "--scene {}: no scene of luxel bench rms has this name; kaykit_city is one", scene);
  return table;
}

}  // namespace luxel::bench
