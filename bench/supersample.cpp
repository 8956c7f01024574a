// luxel bench supersample: what averaging direct light over texels costs, and what it takes away
// of their error.
#include <cmath>

#include "bench/bench.h"
#include "luxel/base/parallel.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/gather/gather.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {
namespace {

constexpr int kSupersampleRounds = 3;
constexpr std::array kSupersamplePoints{1, 4, 16, 64};
/// The judge's points and paths per texel.
constexpr int kSupersampleJudged = 256, kSupersamplePaths = 1024;

/// The lamp of the Cornell box as a point: its shadows have no penumbra.
scene::Scene box_with_point_lamp() {
  scene::Scene scene = scene::cornell_box();
  const Box3 bounds = scene::world_bounds(scene);
  for (scene::Material& material : scene.materials) material.emission = {};
  scene::PunctualLight lamp;
  lamp.position = bounds.centre();
  lamp.position.y = bounds.lower.y + 0.9f * (bounds.upper.y - bounds.lower.y);
  lamp.intensity = {1, 1, 1};
  scene.lights.push_back(lamp);
  return scene;
}

Result<std::vector<Rgb>> mean_over_texels(const validate::Prepared& p, Progress& progress) {
  LUXEL_TRY(const light::Footprints footprints,
            light::footprints(p.input(), kSupersampleJudged, 1234, progress));
  reference::Receivers receivers = reference::receivers(footprints.points);
  receivers.first = footprints.first;
  LUXEL_TRY(const reference::TexelPaths judged,
            reference::irradiance_by_paths(p.scene, receivers, *p.tracer,
                                           {kSupersamplePaths, 0, 99}, progress));
  return judged.irradiance;
}

/// Root mean square of the differences of luminance at `texels` over the mean of all.
double rmse_over_mean(std::span<const Rgb> light, std::span<const Rgb> reference,
                      std::span<const uint32_t> texels) {
  double mean = 0, sum = 0;
  for (const Rgb& b : reference) mean += double(luminance(b)) / double(reference.size());
  for (const uint32_t i : texels) {
    const double d = double(luminance(light[i])) - double(luminance(reference[i]));
    sum += d * d;
  }
  return std::sqrt(sum / double(texels.size())) / mean;
}

struct SupersampleRun {
  gather::Gather light;
  double seconds = INFINITY;  ///< the best of all rounds
};

Result<std::array<SupersampleRun, kSupersamplePoints.size()>> run_all(const validate::Prepared& p,
                                                                      Progress& progress) {
  std::array<SupersampleRun, kSupersamplePoints.size()> runs;
  for (int round = 0; round < kSupersampleRounds; ++round)
    for (size_t k = 0; k < kSupersamplePoints.size(); ++k) {
      gather::GatherParams params;
      params.supersample = kSupersamplePoints[k];
      const auto start = Clock::now();
      LUXEL_TRY(runs[k].light,
                gather::gather({p.scene, p.atlas, p.map, p.elements, p.lights, *p.tracer}, nullptr,
                               params, {}, {}, progress));
      runs[k].seconds = std::min(runs[k].seconds, seconds_since(start));
    }
  return runs;
}

/// Error is asked for where a judge is given: at the texels that are not hidden and were averaged.
Status measure(const std::string& name, scene::Scene scene, int resolution, bool judged,
               Table& table) {
  Progress progress;
  LUXEL_TRY(const auto p, validate::prepare(std::move(scene), resolution, progress));
  LUXEL_TRY(const auto runs, run_all(*p, progress));
  std::vector<Rgb> reference;
  if (judged) {
    LUXEL_TRY(reference, mean_over_texels(*p, progress));
  }
  // Texels that were averaged.
  std::vector<uint32_t> texels;
  for (uint32_t i = 0; i < p->elements.size(); ++i)
    if (!runs[0].light.enclosed[i] && !(runs[2].light.direct[i] == runs[0].light.direct[i]))
      texels.push_back(i);
  // A row per number of points.
  for (size_t k = 0; k < kSupersamplePoints.size(); ++k) {
    const SupersampleRun& run = runs[k];
    const double error = judged ? rmse_over_mean(run.light.direct, reference, texels) : 0;
    table.rows.push_back(
        {name, fmt::format("{0} x {0}", resolution), fmt::format("{}", kSupersamplePoints[k]),
         fmt::format("{:.1f} %", 100 * double(run.light.supersampled) / double(p->elements.size())),
         fmt::format("{:.2f}", run.seconds), fmt::format("{:.2f}", run.seconds / runs[0].seconds),
         judged ? fmt::format("{:.2f} %", 100 * error) : "-"});
    table.json.push_back({{"scene", name},
                          {"resolution", resolution},
                          {"points", kSupersamplePoints[k]},
                          {"averaged_texels", run.light.supersampled},
                          {"texels", p->elements.size()},
                          {"seconds", run.seconds},
                          {"ratio", run.seconds / runs[0].seconds}});
    if (judged) table.json.back()["rmse_over_mean"] = error;
  }
  return {};
}

}  // namespace

Result<Table> measure_supersample(const std::filesystem::path&, int threads) {
  const ThreadLimit limit(threads);
  Table table = new_table("supersample", {"scene", "atlas", "points", "averaged texels",
                                          "gather, s", "ratio", "RMSE / mean there"});
  LUXEL_TRY_STATUS(measure("Cornell box", scene::cornell_box(), 128, true, table));
  LUXEL_TRY_STATUS(measure("with a point lamp", box_with_point_lamp(), 128, true, table));
  LUXEL_TRY_STATUS(measure("Cornell box", scene::cornell_box(), 512, false, table));
  table.notes.push_back(fmt::format(
      "Seconds are the best of {} rounds over all rows in turn, 256 samples, 64 shadow rays. The "
      "error is that of direct light at the texels which 16 points change, against {} paths from "
      "{} "
      "points of each.",
      kSupersampleRounds, kSupersamplePaths, kSupersampleJudged));
  return table;
}

}  // namespace luxel::bench
