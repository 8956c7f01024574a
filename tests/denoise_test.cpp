// `luxel bake --denoise` and the seams of a kit of tiles, from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/command.h"
#include "tests/pictures.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

image::Image bake_for_denoise(const std::filesystem::path& folder, const std::string& scene,
                              const std::string& options) {
  const CommandResult r =
      luxel("bake " + scene_file(scene) + " -o " + folder.string() + " --quiet " + options);
  EXPECT_EQ(r.code, 0) << r.err;
  return lightmap_of(folder);
}

nlohmann::json json_of(const std::filesystem::path& folder) {
  return nlohmann::json::parse(slurp(folder / "bake.json"));
}

/// Root mean square of the relative difference over covered texels, and the difference of means.
struct DenoiseDifference {
  double relative = 0, mean = 0;
};
DenoiseDifference difference_denoise(const image::Image& a, const image::Image& b) {
  double mean = 0, count = 0;
  const auto each = [&](const auto& visit) {
    for (int y = 0; y < b.height; ++y)
      for (int x = 0; x < b.width; ++x)
        if (b.at(x, y)[3] == 1)
          visit(double(luminance(a.rgb(x, y))), double(luminance(b.rgb(x, y))));
  };
  each([&](double, double v) { mean += v, count += 1; });
  mean /= count;
  DenoiseDifference d;
  each([&](double u, double v) {
    const double r = (u - v) / (v + 0.01 * mean);
    d.relative += r * r / count, d.mean += (u - v) / (count * mean);
  });
  d.relative = std::sqrt(d.relative);
  return d;
}

// At 128 x 128 texels, a coarse lightmap, whose light varies from texel to texel more than that of
// the benchmark. The bake of 4096 samples has a tenth of the error of the others.
TEST(SlowDenoise, HalvesTheErrorAndSparesConvergedLight) {
  // Light as it is and denoised, of the same rays.
  const auto bakes = [](const std::string& samples) {
    const ScratchFolder s;
    const auto bake = [&](const std::string& more) {
      return bake_for_denoise(s.path / "b", "cornell-box.glb",
                              "--resolution 128 --no-stitch --keep " + samples + more);
    };
    const image::Image raw = bake("");
    return std::pair{raw, bake(" --denoise")};
  };
  const auto [exact, still] = bakes("--samples 4096 --direct-samples 1024 --seed 7");
  // Each part keeps its sum. Texels inside of solids, which are refilled from others, do not.
  constexpr double kChange = 0.0005;
  for (const char* samples : {"--samples 16 --direct-samples 16", "--samples 64"}) {
    const auto [noisy, denoised] = bakes(samples);
    const DenoiseDifference raw = difference_denoise(noisy, exact);
    const DenoiseDifference quiet = difference_denoise(denoised, exact);
    EXPECT_LT(quiet.relative, raw.relative / 2) << samples;
    EXPECT_LT(std::abs(quiet.mean - raw.mean), kChange) << samples;
  }
  // Denoising changes light without noise by half a percent at most.
  EXPECT_GT(difference_denoise(still, exact).relative, 0) << "not denoised";
  EXPECT_LT(difference_denoise(still, exact).relative, 0.005);
  EXPECT_LT(std::abs(difference_denoise(still, exact).mean), 0.0005);
}

TEST(Denoise, GivesTheSameBitsWithAnyNumberOfThreadsAndSaysSo) {
  const ScratchFolder s;
  const std::string options = "--resolution 64 --samples 16 --denoise --threads ";
  bake_for_denoise(s.path / "1", "cornell-box.glb", options + "1");
  bake_for_denoise(s.path / "3", "cornell-box.glb", options + "3");
  EXPECT_EQ(slurp(s.path / "1" / "lightmap.exr"), slurp(s.path / "3" / "lightmap.exr"));
  const nlohmann::json json = json_of(s.path / "1");
  EXPECT_EQ(json["settings"]["denoise"], true);
  EXPECT_TRUE(json["seconds"].contains("denoise"));
}

TEST(Denoise, WorksWithEverySolverWhoseNoiseIsKnownAndNoOther) {
  const ScratchFolder s;
  for (const char* solver : {"reference --samples 16", "matrix --patches 300 --rays 128"})
    bake_for_denoise(s.path / "b", "cornell-box.glb",
                     std::string("--resolution 32 --denoise --solver ") + solver);
  for (const char* solver : {"hemicube", "hierarchical"}) {
    const CommandResult r = luxel("bake " + scene_file("cornell-box.glb") + " -o " +
                                  (s.path / "c").string() + " --denoise --solver " + solver);
    EXPECT_EQ(r.code, 1);
    EXPECT_THAT(r.err, HasSubstr("does not use --denoise"));
  }
}

// Twenty tiles of two meshes under one lamp, in the shadow of a pillar: no joint is seen. Half a
// percent of the light at the place itself is below what an eye sees at an edge (about 1 %).
TEST(Seams, OfTilesThatTouchAreClosed) {
  const ScratchFolder s;
  bake_for_denoise(s.path / "b", "tiled-kit.glb",
                   "--resolution 256 --samples 64 --direct-samples 64");
  const nlohmann::json json = json_of(s.path / "b");
  EXPECT_EQ(json["counts"]["seams"], 93);
  EXPECT_GT(json["seam_residual_max"][0], 0.5);
  EXPECT_GT(json["seam_residual_p95"][0], 0.02);
  EXPECT_LT(json["seam_residual_max"][1], 0.005);
  EXPECT_LT(json["seam_residual_p95"][1], 0.001);
  bake_for_denoise(s.path / "c", "tiled-kit.glb",
                   "--resolution 256 --samples 64 --direct-samples 64 --no-stitch");
  EXPECT_EQ(json_of(s.path / "c")["seam_residual_max"][1], json["seam_residual_max"][0]);
}

}  // namespace
}  // namespace luxel::testing_support
