// luxel bench bundles: rays of neighbouring texels that share directions, against gather's own.
#include "bench/bundles.h"

#include <algorithm>
#include <ctime>

#include "bench/bench.h"
#include "bench/timing.h"
#include "luxel/base/parallel.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/bake/bake_scene.h"

namespace luxel::bench {
namespace {

constexpr uint32_t kBundleSamples = 256;
constexpr int kBundleRounds = 3;
/// Larger maps are not baked as a whole: it takes minutes.
constexpr int kLargestBaked = 1024;

struct BundleScene {
  const char* name;
  std::filesystem::path file;
};

/// The last two are those that bench/peers/compare.py makes.
std::vector<BundleScene> bundle_scenes(const std::filesystem::path& shared) {
  const auto scenes = shared / "scenes",
             made = std::filesystem::temp_directory_path() / "luxel-peers";
  return {{"cornell_box", scenes / "cornell_box/cornell_box.glb"},
          {"tile_game_room", scenes / "tile_game_room/tile_game_room_lit_uv1.glb"},
          {"living_room", scenes / "living_room/living_room_lit_uv1.glb"},
          {"two_rooms", made / "two_rooms.glb"},
          {"courtyard", made / "courtyard.glb"}};
}

/// All texels of a small map; of a larger one some squares of 64 x 64.
std::vector<uint32_t> texels_to_trace(const validate::Prepared& p) {
  const uint32_t one_in = p.atlas.resolution <= 256 ? 1 : p.atlas.resolution <= 1024 ? 16 : 128;
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < p.map.texels.size(); ++i) {
    const atlas::Texel& t = p.map.texels[i];
    if ((t.x / 64u + 5 * (t.y / 64u)) % one_in == 0) out.push_back(i);
  }
  return out;
}

/// Processor seconds of making and tracing the rays of all texels; the least of all rounds.
struct BundleSeconds {
  double hybrid = 1e30;  ///< gather's rays in packets that are not declared coherent
  double gather = 1e30;  ///< as gather traces them: in scenes of few triangles in coherent packets
  double by_embree = 1e30, projected = 1e30;  ///< bundles

  std::array<std::pair<std::string_view, double>, 4> named() const {
    return {
        {{"hybrid", hybrid}, {"gather", gather}, {"bundles", by_embree}, {"projected", projected}}};
  }
};

BundleSeconds time_bundles(const BundleTrace& in, std::span<const uint32_t> texels,
                           const Bundles& bundles) {
  const auto timed = [](double& least, const auto& run) {
    const std::clock_t start = std::clock();
    run();
    least = std::min(least, processor_seconds_since(start));
  };
  BundleSeconds out;
  for (int round = 0; round < kBundleRounds; ++round) {
    timed(out.hybrid, [&] { trace_as_gather(in, texels, trace::Packets::any); });
    timed(out.gather, [&] { trace_as_gather(in, texels, trace::Packets::alike); });
    timed(out.by_embree, [&] { trace_bundles(in, bundles, BundleTracer::embree); });
    timed(out.projected, [&] { trace_bundles(in, bundles, BundleTracer::projection); });
  }
  return out;
}

/// Processor seconds of a whole bake without drawing and writing.
Result<double> whole_bake_seconds(const BundleScene& scene, int resolution) {
  pipeline::BakeSettings settings;
  settings.scene = scene.file, settings.output = std::filesystem::temp_directory_path();
  settings.resolution = resolution, settings.samples = int(kBundleSamples);
  Progress progress;
  const std::clock_t start = std::clock();
  LUXEL_TRY(const pipeline::Bake bake, pipeline::bake_scene(settings, progress));
  return processor_seconds_since(start);
}

/// Share of a bake's time that remains when its rays take less time, and all else as long.
double time_left(double share, double seconds, double seconds_as_gather) {
  return 1 - share * (1 - seconds / seconds_as_gather);
}

void add_bundle_row(const BundleScene& scene, int resolution, double rays, const BundleSeconds& s,
                    double bundle_size, double share, Table& table) {
  std::vector<std::string> row{scene.name, fmt::format("{0} x {0}", resolution)};
  nlohmann::json json{{"scene", scene.name},
                      {"resolution", resolution},
                      {"rays_in_a_bundle", bundle_size},
                      {"share_of_bake", share}};
  for (const auto& [name, seconds] : s.named()) {
    row.push_back(fmt::format("{:.1f}", rays / seconds * 1e-6));
    json[std::string(name) + "_mrays_per_s"] = rays / seconds * 1e-6;
  }
  row.push_back(fmt::format("{:.0f}", bundle_size));
  row.push_back(share > 0 ? fmt::format("{:.0f} %", 100 * share) : "");
  for (const double seconds : {s.by_embree, s.projected})
    row.push_back(share > 0 ? fmt::format("{:.2f}", time_left(share, seconds, s.gather)) : "");
  table.rows.push_back(row), table.json.push_back(json);
}

Status measure_bundled_map(const BundleScene& scene, int resolution, Table& table) {
  LUXEL_TRY(import::Imported imported, import::import_scene(scene.file));
  Progress progress;
  LUXEL_TRY(const auto p, validate::prepare(std::move(imported.scene), resolution, progress));
  const BundleTrace in = bundle_trace(*p, kBundleSamples);
  const std::vector<uint32_t> texels = texels_to_trace(*p);
  const Bundles bundles = make_bundles(*p, texels);
  if (const double share = share_that_differs(in, bundles); share > 1e-4)
    return fail(ErrorCode::unsupported,
                "{}: {:.4f} % of the projected rays meet other places than Embree says", scene.name,
                100 * share);
  const BundleSeconds s = time_bundles(in, texels, bundles);
  double share = 0;
  if (resolution <= kLargestBaked) {
    LUXEL_TRY(const double bake, whole_bake_seconds(scene, resolution));
    share = s.gather * double(p->elements.size()) / double(texels.size()) / bake;
  }
  add_bundle_row(scene, resolution, double(texels.size()) * kBundleSamples, s, bundles.mean_size(),
                 share, table);
  return {};
}

}  // namespace

Result<Table> measure_bundles(const std::filesystem::path& shared, int threads) {
  const ThreadLimit limit(threads);
  Table table = new_table("bundles", {"scene", "map", "hybrid, Mrays/s", "gather, Mrays/s",
                                      "bundles, Mrays/s", "projected, Mrays/s", "rays in a bundle",
                                      "rays / bake", "bake, bundles", "bake, projected"});
  for (const BundleScene& scene : bundle_scenes(shared)) {
    if (!std::filesystem::exists(scene.file)) {
      table.notes.push_back(scene.file.string() + " is not on this machine: left out");
      continue;
    }
    for (const int resolution : {256, 1024, 4096})
      LUXEL_TRY_STATUS(measure_bundled_map(scene, resolution, table));
    LUXEL_TRY_STATUS(measure_shared_noise(scene.file, scene.name, table));
  }
  table.notes.push_back(fmt::format(
      "Mrays per second of one processor, making them included, of {} for each texel; the best of "
      "{} rounds in turn; on maps above 256 x 256 those of some texels.",
      kBundleSamples, kBundleRounds));
  return table;
}

}  // namespace luxel::bench
