// What is left of single bright texels in denoised bakes, and what small bright things lose.
#include <gtest/gtest.h>
#include <cstdio>
#include <cstdlib>

#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/bake/denoise_light.h"
#include "luxel/export/baked_glb.h"
#include "luxel/base/file.h"
#include "tests/gallery.h"

namespace luxel::pipeline {
namespace {

TEST(Fireflies, Try) {
  Progress progress;
  const int res = std::atoi(std::getenv("RES"));
  BakeSettings s;
  s.output = std::filesystem::temp_directory_path();
  s.resolution = res;
  s.samples = 512, s.direct_samples = 512, s.supersample = 16; s.seed = 77; s.denoise = true;
  std::vector<Rgb> truth;
  const std::string file = "/tmp/c/truth" + std::to_string(res) + ".bin";
  s.stitch = false;
  if (FILE* f = std::fopen(file.c_str(), "rb")) {
    std::fseek(f, 0, SEEK_END); truth.resize(size_t(std::ftell(f)) / sizeof(Rgb)); std::rewind(f);
    (void)!std::fread(truth.data(), sizeof(Rgb), truth.size(), f); std::fclose(f);
  } else {
    auto t = bake_scene(testing_support::gallery_of_spots(), s, progress);
    ASSERT_TRUE(t);
    truth = t->light.irradiance;
    FILE* g = std::fopen(file.c_str(), "wb"); std::fwrite(truth.data(), sizeof(Rgb), truth.size(), g); std::fclose(g);
  }
  double mean = 0;
  for (auto& e : truth) mean += double(luminance(e)) / truth.size();
  std::printf("texels %zu mean %g\n", truth.size(), mean);
  s.seed = std::getenv("SEED") ? std::atoi(std::getenv("SEED")) : 1; s.supersample = 16;
  int samples = 16; int direct = std::getenv("DIRECT") ? std::atoi(std::getenv("DIRECT")) : 32;
  s.samples = samples, s.direct_samples = direct, s.denoise = false;
  auto bake = bake_scene(testing_support::gallery_of_spots(), s, progress);
  ASSERT_EQ(truth.size(), bake->map.texels.size());
  const TexelLight raw = bake->light;
  trace::RayTracer tracer = *trace::RayTracer::build(bake->scene);
  auto elements = transport::elements_from_texels(bake->scene, bake->atlas, bake->map);
  auto lights = light::collect_lights(bake->scene);
  light::TexelScene in{bake->scene, bake->atlas, bake->map, elements, lights, tracer};
  std::printf("pieces %zu\n", lights.triangles.size());
  for (bool dn : {false, true}) {
    if (dn) ASSERT_TRUE(denoise_light(in, true, bake->light, progress));
    size_t count13 = 0, count2 = 0; double m = 0, md = 0, mr = 0, sq = 0;
    for (size_t i = 0; i < bake->map.texels.size(); ++i) {
      m += double(luminance(bake->light.irradiance[i])) / bake->map.texels.size();
      if (bake->light.hidden[i]) continue;
      const auto& t = bake->map.texels[i];
      float most = 0; Rgb around{};
      for (int dy = -1; dy <= 1; ++dy) for (int dx = -1; dx <= 1; ++dx) {
        int x = t.x + dx, y = t.y + dy;
        if (x < 0 || y < 0 || x >= bake->map.resolution || y >= bake->map.resolution) continue;
        auto j = bake->map.texel_at[size_t(y) * bake->map.resolution + x];
        if (j == atlas::kNone) continue;
        most = std::max(most, luminance(truth[j]));
        if (j != i && luminance(raw.direct[j]) > luminance(around)) around = raw.direct[j];
      }
      float l = luminance(bake->light.irradiance[i]), tr = luminance(truth[i]);
      sq += double(l - tr) * (l - tr) / bake->map.texels.size();
      const bool a = l > 1.3 * most + 0.02 * mean;
      count13 += a, count2 += l > 2 * most + 0.02 * mean;
      if (a && dn) { 
        std::printf("    %d %d inst %d: %.3f truth %.3f most %.3f | direct raw %.3f sd %.3f around %.3f now %.3f| rest raw %.3f sd %.3f\n", t.x, t.y, int(t.sample.instance), l/mean, luminance(truth[i])/mean, most/mean,
        luminance(raw.direct[i])/mean, std::sqrt(raw.direct_variance[i])/mean, luminance(around)/mean, luminance(bake->light.direct[i])/mean, luminance(raw.irradiance[i]-raw.direct[i])/mean, std::sqrt(raw.variance[i])/mean); }
    }
    if (std::getenv("AX") && !dn) { int ax = std::atoi(std::getenv("AX")), ay = std::atoi(std::getenv("AY"));
      for (int y = ay - 3; y <= ay + 3; ++y) { for (int x = ax - 4; x <= ax + 4; ++x) { auto j = x < 0 || y < 0 || x >= res || y >= res ? atlas::kNone : bake->map.texel_at[size_t(y) * res + x];
        if (j == atlas::kNone) std::printf("  -   "); else std::printf("%.2f~%.2f(%.2f) ", luminance(raw.irradiance[j]-raw.direct[j])/mean, std::sqrt(raw.variance[j])/mean, (luminance(truth[j]))/mean); } std::printf("\n"); } }
    std::printf("samples %d direct %d denoise %d: x1.3 %zu, x2 %zu, mean %+.3f %%, rmse %.3f %%\n", samples, direct, dn, count13, count2, 100 * (m / mean - 1), 100 * std::sqrt(sq) / mean);
  }
}

}  // namespace
}  // namespace luxel::pipeline
