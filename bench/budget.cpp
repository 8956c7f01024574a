// luxel bench budget: how long it takes to a known error, and whether plans, budgets and the time
// left that is shown hold.
#include <atomic>
#include <cmath>
#include <thread>

#include "bench/bench.h"
#include "bench/judged_texels.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/bake/bake_scene.h"

namespace luxel::bench {
namespace {

/// The most samples, and the judge's paths at a texel, in two halves.
constexpr int kPaths = 16384;
constexpr double kGoal = 0.01;
/// Twice the samples that leave more than this part of an error lessen its noise no longer.
constexpr double kNoLonger = 0.95;
constexpr std::array kJudgedScenes{"cornell_box/cornell_box.glb",
                                   "living_room/living_room_lit_uv1.glb",
                                   "tile_game_room/tile_game_room_lit_uv1.glb"};
constexpr std::array kPlannedScenes{"cornell_box/cornell_box.glb", "living_room/living_room.glb",
                                    "tile_game_room/tile_game_room6.glb", "suzanne_room/room.glb",
                                    "kaykit_city/kaykit_city.glb"};

pipeline::BakeSettings settings_of(const std::filesystem::path& scene) {
  pipeline::BakeSettings settings;
  settings.scene = scene;
  settings.output = std::filesystem::temp_directory_path();
  return settings;
}

struct TimedBake {
  pipeline::Bake bake;
  double seconds = 0;
};
Result<TimedBake> timed(const pipeline::BakeSettings& settings) {
  Progress progress;
  const auto start = Clock::now();
  LUXEL_TRY(pipeline::Bake bake, pipeline::bake_scene(settings, progress));
  return TimedBake{std::move(bake), seconds_since(start)};
}

/// The least samples, doubled from 64, with which a bake is as near to the paths as is asked for. A
/// quarter as many shadow rays, where that is more than there are anyway: else their noise is what
/// is left.
Status measure_to_one_percent(const std::filesystem::path& scene, Table& table) {
  pipeline::BakeSettings settings = settings_of(scene);
  settings.resolution = 256, settings.uv = atlas::UvMode::keep;
  settings.stitch = false;  // which changes texels beside seams on purpose
  std::optional<JudgedTexels> judged;
  // Samples are doubled until the error is small enough.
  for (settings.samples = 64; settings.samples <= kPaths; settings.samples *= 2) {
    settings.direct_samples =
        std::max(first_direct_samples(pipeline::BakeSettings{}), settings.samples / 4);
    LUXEL_TRY(const TimedBake t, timed(settings));
    if (!judged) {
      LUXEL_TRY(judged, judge_texels(t.bake, kPaths / 2));
    }
    const double error = rmse_over_mean(t.bake, *judged);
    table.rows.push_back({scene.stem().string(), fmt::format("{}", settings.samples),
                          fmt::format("{:.2f}", t.seconds), fmt::format("{:.2f} %", 100 * error),
                          fmt::format("{:.2f} %", 100 * t.bake.light.relative_error)});
    table.json.push_back({{"scene", scene.stem().string()},
                          {"samples", settings.samples},
                          {"seconds", t.seconds},
                          {"rmse_over_mean", error},
                          {"stated", t.bake.light.relative_error}});
    if (error <= kGoal) break;
  }
  return {};
}

/// Rays of a bake to an error over those of the least uniform bake, by doublings, that is as sure
/// at 95 of 100 texels.
Status compare_adaptive(const std::filesystem::path& scene, Table& table) {
  pipeline::BakeSettings settings = settings_of(scene);
  settings.resolution = 256, settings.uv = atlas::UvMode::keep;
  for (const double asked : {0.1, 0.05, 0.02}) {
    settings.max_error = asked;
    LUXEL_TRY(const TimedBake adaptive, timed(settings));
    settings.max_error = 0;
    // Between two doublings the error is taken for a power of the samples.
    double rays_before = 0, error_before = 0;
    const double goal = double(adaptive.bake.light.error_p95);
    for (settings.samples = 32; settings.samples <= 1 << 15; settings.samples *= 2) {
      settings.direct_samples = settings.samples;
      LUXEL_TRY(const TimedBake uniform, timed(settings));
      const double error = double(uniform.bake.light.error_p95);
      const double rays = double(uniform.bake.light.rays);
      if (error > goal && error > kNoLonger * error_before && rays_before > 0) {
        table.notes.push_back(fmt::format(
            "{} to {:.1f} % (reached: {:.1f} %): {:.1f} Mrays in {:.1f} s; uniform "
            "sampling has {:.1f} % with {} samples, hardly less than with half of them.",
            scene.stem().string(), 100 * asked, 100 * goal, double(adaptive.bake.light.rays) * 1e-6,
            adaptive.seconds, 100 * error, settings.samples));
        break;
      }
      if (error > goal) {
        rays_before = rays, error_before = error;
        continue;
      }
      const double part =
          rays_before > 0 ? std::log(error_before / goal) / std::log(error_before / error) : 1;
      const double needed =
          rays_before > 0 ? rays_before * std::pow(rays / rays_before, part) : rays;
      const double ratio = double(adaptive.bake.light.rays) / needed;
      table.notes.push_back(fmt::format(
          "{} to {:.1f} % (reached: {:.1f} %): {:.1f} Mrays, {:.2f} of the {:.1f} that uniform "
          "sampling needs; {:.1f} s.",
          scene.stem().string(), 100 * asked, 100 * goal, double(adaptive.bake.light.rays) * 1e-6,
          ratio, needed * 1e-6, adaptive.seconds));
      table.json.push_back({{"scene", scene.stem().string()},
                            {"max_error", asked},
                            {"reached", goal},
                            {"rays", adaptive.bake.light.rays},
                            {"rays_of_uniform", needed},
                            {"ratio", ratio}});
      break;
    }
    settings.direct_samples = pipeline::BakeSettings{}.direct_samples;
  }
  return {};
}

struct Watched {
  double seconds = 0;
  std::vector<std::pair<double, double>> shown;  ///< when, and seconds left, < 0: not known

  /// Time left as shown once a share of the bake was over, over the true time left; < 0: unknown.
  double ratio_at(double share) const {
    for (const auto& [at, left] : shown)
      if (at >= share * seconds) return left < 0 ? -1 : left / (seconds - at);
    return -1;
  }
  /// The share of the bake that was over when time left was first shown; 1: it never was.
  double first_known() const {
    for (const auto& [at, left] : shown)
      if (left >= 0) return at / seconds;
    return 1;
  }
};

std::string ratio_text(double ratio) {
  return ratio < 0 ? "not yet known" : fmt::format("{:.2f}", ratio);
}
nlohmann::json known_or_null(double ratio) {
  return ratio < 0 ? nlohmann::json() : nlohmann::json(ratio);
}

Result<Watched> watch(const pipeline::BakeSettings& settings) {
  Watched out;
  Progress progress;
  std::atomic<bool> done{false};
  const auto start = Clock::now();
  std::thread watcher([&] {
    while (!done) {
      out.shown.emplace_back(seconds_since(start), progress.snapshot().seconds_left);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  });
  const Result<pipeline::Bake> bake = pipeline::bake_scene(settings, progress);
  out.seconds = seconds_since(start);
  done = true;
  watcher.join();
  if (!bake) return Failure{bake.error()};
  return out;
}

Status measure_plan(const std::filesystem::path& scene, Table& table) {
  pipeline::BakeSettings settings = settings_of(scene);
  settings.resolution = 1024;
  LUXEL_TRY(settings.outside.sky, pipeline::parse_sky("135,45"));
  Progress progress;
  LUXEL_TRY(const pipeline::Plan plan, pipeline::plan_bake(settings, progress));
  LUXEL_TRY(const Watched watched, watch(settings));
  const double first = watched.first_known();
  table.notes.push_back(fmt::format(
      "{}, 1024 x 1024, sun and sky: planned {:.1f} s, took {:.1f} s, ratio {:.2f}; time left "
      "first shown when {:.0f} % was over; over the truth then {}, when a tenth was over {}, half "
      "{}.",
      scene.stem().string(), plan.seconds, watched.seconds, plan.seconds / watched.seconds,
      100 * first, ratio_text(watched.ratio_at(first)), ratio_text(watched.ratio_at(0.1)),
      ratio_text(watched.ratio_at(0.5))));
  table.json.push_back({{"scene", scene.stem().string()},
                        {"planned_s", plan.seconds},
                        {"seconds", watched.seconds},
                        {"left_first_known_at", first},
                        {"left_when_first_known", known_or_null(watched.ratio_at(first))},
                        {"left_at_a_tenth", known_or_null(watched.ratio_at(0.1))},
                        {"left_at_half", known_or_null(watched.ratio_at(0.5))}});
  return {};
}

Status measure_time_budget(const std::filesystem::path& scene, Table& table) {
  pipeline::BakeSettings settings = settings_of(scene);
  LUXEL_TRY(settings.outside.sky, pipeline::parse_sky("135,45"));
  for (const double budget : {3, 10, 30}) {
    settings.time_budget_s = budget;
    LUXEL_TRY(const TimedBake t, timed(settings));
    table.notes.push_back(fmt::format(
        "{}, 512 x 512, --time-budget {}: {:.1f} s, 95 of 100 texels to {:.1f} %.",
        scene.stem().string(), budget, t.seconds, 100 * double(t.bake.light.error_p95)));
    table.json.push_back({{"scene", scene.stem().string()},
                          {"time_budget_s", budget},
                          {"seconds", t.seconds},
                          {"relative_p95", t.bake.light.error_p95}});
  }
  return {};
}

}  // namespace

Result<Table> measure_budget(const std::filesystem::path& shared, int threads) {
  return measure_budget_in(shared, "", threads);
}

Result<Table> measure_budget_in(const std::filesystem::path& shared, const std::string& scene,
                                int threads) {
  const ThreadLimit limit(threads);
  Table table = new_table(
      "budget", {"scene, 256 x 256, --uv keep", "samples", "seconds", "RMSE over mean", "stated"});
  bool is_known = scene.empty();
  const auto for_scene = [&](const char* file, const auto& measure) -> Status {
    const auto path = shared / "scenes" / file;
    if (!scene.empty() && path.stem() != scene) return {};
    is_known = true;
    if (std::filesystem::exists(path)) return measure(path, table);
    table.notes.push_back(path.string() + " is not on this machine: left out");
    return {};
  };
  LUXEL_TRY_STATUS(for_scene(kJudgedScenes[1], compare_adaptive));
  LUXEL_TRY_STATUS(for_scene(kPlannedScenes[1], measure_time_budget));
  for (const char* file : kPlannedScenes) LUXEL_TRY_STATUS(for_scene(file, measure_plan));
  for (const char* file : kJudgedScenes) LUXEL_TRY_STATUS(for_scene(file, measure_to_one_percent));
  if (!is_known)
    return fail(ErrorCode::bad_setting,
                "--scene {}: no scene of luxel bench budget has this name; kaykit_city is one",
                scene);
  table.notes.push_back(fmt::format(
      "Judged at 2,500 texels by {} paths each, whose noise is taken away. Seams are not "
      "stitched. Seconds are those of the whole bake, without writing files.",
      kPaths));
  return table;
}

}  // namespace luxel::bench
