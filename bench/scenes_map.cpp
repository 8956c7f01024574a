// A map with a sun, shining through windows: gather against the path tracer.
#include "bench/judged_texels.h"
#include "bench/scenes.h"
#include "luxel/import/environment.h"
#include "luxel/import/import.h"
#include "luxel/validate/agreement.h"

namespace luxel::bench {
namespace {

constexpr int kScenesMapPaths = 4096, kScenesMapSamples = 1024;

Status measure_at(const scene::Scene& scene, int resolution, Table& table) {
  Progress progress;
  LUXEL_TRY(const auto p, validate::prepare(scene, resolution, progress));
  // Paths at some texels.
  const std::vector<size_t> texels = some_texels(p->elements.size());
  const auto position = chosen<Vec3>(p->elements.position, texels);
  const auto normal = chosen<Vec3>(p->elements.normal, texels);
  const auto flat = chosen<Vec3>(p->elements.geometric_normal, texels);
  LUXEL_TRY(const validate::Judged judged,
            validate::judge(p->scene, *p->tracer, {position, normal, flat}, kScenesMapPaths, 1,
                            progress));
  // gather at all of them.
  pipeline::BakeSettings settings;
  settings.samples = kScenesMapSamples, settings.direct_samples = kScenesMapSamples / 4;
  LUXEL_TRY(const validate::Timed solved, validate::solve(*p, "gather", settings, progress));
  const validate::Agreement a =
      validate::agreement(chosen<Rgb>(solved.light.irradiance, texels),
                          chosen<uint8_t>(solved.light.hidden, texels), judged);
  table.notes.push_back(fmt::format(
      "kloppenheim_05_1k on living_room, {0} x {0}, {1} samples: relative RMSE {2} against twice "
      "{3} paths at {4} of {5} texels (resolution {6:.2f} %), bias {7:+.3f} % of the mean, {8:.1f} "
      "s; the paths took {9:.0f} s.",
      resolution, kScenesMapSamples, validate::relative_rmse_text(a), kScenesMapPaths,
      texels.size(), p->elements.size(), 100 * a.resolution, 100 * a.bias_over_mean, solved.seconds,
      judged.seconds));
  table.json.push_back({{"scene", "living_room under kloppenheim_05_1k"},
                        {"resolution_texels", resolution},
                        {"relative_rmse", a.relative_rmse},
                        {"resolution", a.resolution},
                        {"bias_over_mean", a.bias_over_mean},
                        {"seconds", solved.seconds}});
  return {};
}

}  // namespace

Status measure_map(const std::filesystem::path& shared, Table& table) {
  const auto room = shared / "scenes/living_room/living_room.glb";
  const auto sky = shared / "scenes/sky/kloppenheim_05_1k.hdr";
  if (!std::filesystem::exists(room) || !std::filesystem::exists(sky)) return {};
  LUXEL_TRY(import::Imported imported, import::import_scene(room));
  LUXEL_TRY(import::ImportedEnvironment map, import::read_environment(sky, 0, 1));
  imported.scene.environment = std::move(map.map);
  for (const int resolution : {128, 256})
    LUXEL_TRY_STATUS(measure_at(imported.scene, resolution, table));
  return {};
}

}  // namespace luxel::bench
