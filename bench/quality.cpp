// luxel bench quality: how different pictures of bakes look from that of a long one, for the
// processor time that they take.
#include <cmath>
#include <ctime>

#include "bench/bench.h"
#include "luxel/base/parallel.h"
#include "luxel/display/draw.h"
#include "luxel/display/tone_map.h"
#include "luxel/image/flip.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/settings/quality.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::bench {
namespace {

constexpr int kQualityResolution = 256, kQualityWidth = 480, kQualityHeight = 360;

struct QualityScene {
  std::string_view file, sky;
};
constexpr std::array kQualityScenes{
    QualityScene{"cornell_box/cornell_box.glb", ""},
    QualityScene{"living_room/living_room_lit_uv1.glb", ""},
    QualityScene{"tile_game_room/tile_game_room_lit_uv1.glb", ""},
    QualityScene{"suzanne_room/room.glb", "135,40"},
    QualityScene{"japanese_bridge_garden/japanese_bridge_garden.glb", ""},
    QualityScene{"spot_teapot_bunny/spot.obj", "135,40"}};

struct QualityRow {
  std::string_view name;
  pipeline::QualityNumbers numbers;
};

std::vector<QualityRow> quality_rows() {
  using pipeline::Quality;
  return {{"--quality draft", pipeline::numbers_of(Quality::draft)},
          {"half the shadow rays of good", {128, 16, 16, true}},
          {"half the points of good", {128, 32, 8, true}},
          {"half the rays of good", {64, 32, 16, true}},
          {"--quality good", pipeline::numbers_of(Quality::good)},
          {"good, --no-denoise", {128, 32, 16, false}},
          {"twice good", {256, 64, 16, true}},
          {"the default before", {256, 64, 16, false}},
          {"--quality best", pipeline::numbers_of(Quality::best)}};
}

Result<pipeline::BakeSettings> settings_of(const std::filesystem::path& file,
                                           const QualityScene& scene,
                                           const pipeline::QualityNumbers& numbers, int threads) {
  pipeline::BakeSettings s;
  s.scene = file, s.output = std::filesystem::temp_directory_path(), s.threads = threads;
  s.resolution = kQualityResolution, s.samples = numbers.samples;
  s.direct_samples = numbers.direct_samples, s.supersample = numbers.supersample;
  s.denoise = numbers.denoise;
  if (!scene.sky.empty()) {
    LUXEL_TRY(s.outside.sky, pipeline::parse_sky(scene.sky));
  }
  return s;
}

/// What the bake's own camera sees, drawn from the lightmap's texels.
Result<image::Image> picture_of(const pipeline::Bake& bake, Progress& progress) {
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(bake.scene));
  const transport::TexelField field{&bake.atlas, &bake.map, bake.light.irradiance};
  display::DrawParams params;
  params.width = kQualityWidth, params.height = kQualityHeight;
  return display::draw(
      bake.scene, tracer, bake.view.camera,
      [&](const scene::SurfacePoint& p) { return transport::irradiance_at(field, p); }, params,
      progress);
}

image::Image shown(const image::Image& radiance, float exposure) {
  image::Image out(radiance.width, radiance.height, 3);
  for (int y = 0; y < radiance.height; ++y)
    for (int x = 0; x < radiance.width; ++x)
      out.set_rgb(x, y, display::compress(radiance.rgb(x, y) * exposure));
  return out;
}

double mean_flip(const image::Image& picture, const image::Image& reference) {
  const float exposure = display::auto_exposure(reference);
  const image::Image map = image::flip(shown(picture, exposure), shown(reference, exposure));
  double sum = 0;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) sum += double(map.at(x, y)[0]);
  return sum / (double(map.width) * map.height);
}

/// Standard error of a part of the light over the mean light.
double noise_of(const pipeline::Bake& bake, std::span<const float> variance) {
  double light = 0, sum = 0;
  for (const Rgb& e : bake.light.irradiance) light += double(luminance(e));
  for (const float v : variance) sum += double(v);
  const double n = double(bake.light.irradiance.size());
  return light > 0 ? std::sqrt(sum / n) / (light / n) : 0;
}

Status measure_scene(const std::filesystem::path& file, const QualityScene& scene, int threads,
                     Table& table) {
  Progress progress;
  LUXEL_TRY(pipeline::BakeSettings longest,
            settings_of(file, scene, {2048, 512, 64, false}, threads));
  longest.seed = 1000;
  LUXEL_TRY(const pipeline::Bake truth, pipeline::bake_scene(longest, progress));
  LUXEL_TRY(const image::Image reference, picture_of(truth, progress));
  const std::string name = file.stem().string();
  for (const QualityRow& row : quality_rows()) {
    LUXEL_TRY(const pipeline::BakeSettings settings,
              settings_of(file, scene, row.numbers, threads));
    // Processor seconds: those of a clock on the wall say how busy the machine is.
    const std::clock_t start = std::clock();
    LUXEL_TRY(const pipeline::Bake bake, pipeline::bake_scene(settings, progress));
    const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    LUXEL_TRY(const image::Image picture, picture_of(bake, progress));
    const double flip = mean_flip(picture, reference);
    const double indirect = noise_of(bake, bake.light.variance);
    const double direct = noise_of(bake, bake.light.direct_variance);
    const auto& [samples, direct_samples, points, denoise] = row.numbers;
    table.rows.push_back({name, std::string(row.name),
                          fmt::format("{} / {} / {}", samples, direct_samples, points),
                          fmt::format("{:.1f}", seconds), fmt::format("{:.4f}", flip),
                          percent(indirect), percent(direct)});
    table.json.push_back({{"scene", name},
                          {"setting", row.name},
                          {"samples", samples},
                          {"direct_samples", direct_samples},
                          {"supersample", points},
                          {"denoise", denoise},
                          {"cpu_seconds", seconds},
                          {"flip", flip},
                          {"indirect_noise", indirect},
                          {"direct_noise", direct}});
  }
  return {};
}

}  // namespace

Result<Table> measure_quality(const std::filesystem::path& shared, int threads) {
  const ThreadLimit limit(threads);
  Table table =
      new_table("quality", {"scene", "setting", "rays / shadow rays / points", "processor s",
                            "FLIP", "noise of indirect light", "noise of direct light"});
  for (const QualityScene& scene : kQualityScenes) {
    const auto file = shared / "scenes" / scene.file;
    if (!std::filesystem::exists(file)) continue;
    LUXEL_TRY_STATUS(measure_scene(file, scene, threads, table));
  }
  table.notes.push_back(
      "256 x 256 texels; mean FLIP of 480 x 360 pixels against a bake of 2048 rays, 512 shadow "
      "rays and 64 points. Noise is before the denoiser, over the mean light.");
  return table;
}

}  // namespace luxel::bench
