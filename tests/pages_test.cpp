// --pages: several lightmaps from one bake.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/image/codec.h"
#include "tests/command.h"
#include "tests/pictures.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

CommandResult bake_for_pages(const std::string& scene, const fs::path& output,
                             const std::string& options) {
  return luxel("bake " + scene_file(scene) + " -o " + output.string() + " --quiet " + options);
}

nlohmann::json about(const fs::path& folder) {
  return nlohmann::json::parse(slurp(folder / "bake.json"));
}

// A furnace whose walls have emission 1 and reflectance 1/2 : B = pi + E / 2 and E = B, so E = 2 pi
// everywhere. Gather with 64 rays in a closed room of one radiosity: what varies is the direct
// light, estimated with 64 shadow rays.
TEST(Pages, HoldTheLightOfAFurnace) {
  const ScratchFolder s;
  for (const char* pages : {"2", "mesh"}) {
    const fs::path folder = s.path / pages;
    ASSERT_EQ(
        bake_for_pages("furnace-box.glb", folder,
                       std::string("--resolution 48 --samples 64 --uv unwrap --pages ") + pages)
            .code,
        0);
    const nlohmann::json atlas = about(folder)["atlas"];
    for (const nlohmann::json& page : atlas["pages"]) {
      const image::Image light = exr_at(folder / page["file"].get<std::string>());
      EXPECT_EQ(light.width, page["resolution"]);
      int covered = 0;
      for (int y = 0; y < light.height; ++y)
        for (int x = 0; x < light.width; ++x)
          if (light.at(x, y)[3] > 0) {
            EXPECT_NEAR(light.rgb(x, y).x, 2 * kPi, 0.05 * 2 * kPi) << page;
            ++covered;
          }
      EXPECT_GT(covered, light.width * light.height / 3);
    }
  }
}

// One density, on one page and on as many smaller ones as it takes: pictures drawn from the files
// agree up to the noise of two bakes with other texels. The reference is a third bake on one page,
// with another seed: no farther may the pages be than that, half as much again.
TEST(Pages, ShowWhatOnePageShows) {
  const ScratchFolder s;
  const std::string scene = "cornell-box.glb";
  const std::string options = "--samples 128 --uv unwrap --texels-per-metre 100 ";
  ASSERT_EQ(bake_for_pages(scene, s.path / "one", options).code, 0);
  ASSERT_EQ(bake_for_pages(scene, s.path / "seed", options + "--seed 7").code, 0);
  ASSERT_EQ(bake_for_pages(scene, s.path / "pages", options + "--pages auto --resolution 64").code,
            0);
  const nlohmann::json one = about(s.path / "one")["atlas"],
                       pages = about(s.path / "pages")["atlas"];
  EXPECT_EQ(one["pages"].size(), 1u);
  EXPECT_GE(pages["pages"].size(), 2u);
  EXPECT_EQ(pages["resolution"], 64);
  EXPECT_NEAR(pages["texels_per_metre"].get<double>(), one["texels_per_metre"].get<double>(), 0.05);
  const auto picture = [&](const char* folder) {
    const fs::path file = s.path / (std::string(folder) + ".exr");
    const CommandResult r = luxel("render " + scene_file(scene) +
                                  " --technique lightmap --size 160x160 --quiet --from " +
                                  (s.path / folder).string() + " -o " + file.string());
    EXPECT_EQ(r.code, 0) << r.err;
    return file.string();
  };
  const auto rmse = [&](const std::string& a, const std::string& b) {
    const CommandResult r = luxel("compare " + a + " " + b + " --json --quiet");
    EXPECT_EQ(r.code, 0) << r.err;
    const nlohmann::json json = nlohmann::json::parse(r.out);
    EXPECT_LT(std::abs(json["bias_over_mean"].get<double>()), 0.005);
    return json["rmse_over_mean"].get<double>();
  };
  const std::string reference = picture("one");
  const double noise = rmse(picture("seed"), reference), off = rmse(picture("pages"), reference);
  std::printf("another seed %.4f of the mean, pages %.4f\n", noise, off);
  EXPECT_LT(off, 1.5 * noise);
}

TEST(Pages, LeaveEveryFormatOfEveryPage) {
  const ScratchFolder s;
  const fs::path folder = s.path / "b";
  ASSERT_EQ(
      bake_for_pages("cornell-box.glb", folder,
                     "--resolution 48 --samples 8 --pages 2 --uv unwrap --formats hdr,rgbm,rgbe "
                     "--directional sh1")
          .code,
      0);
  std::set<std::string> expected = kBakeFiles;
  expected.erase("lightmap.exr");
  for (const std::string page : {"lightmap-0", "lightmap-1"})
    for (const char* ending :
         {".exr", ".hdr", ".rgbm.png", ".rgbe.png", ".x.exr", ".y.exr", ".z.exr"})
      expected.insert(page + ending);
  EXPECT_EQ(files_in(folder), expected);
  EXPECT_EQ(about(folder)["files"].get<std::set<std::string>>(), expected);
  // One range for the pages: its largest value is the largest of all.
  float largest = 0;
  for (const char* page : {"lightmap-0.exr", "lightmap-1.exr"}) {
    const image::Image light = exr_at(folder / page);
    for (int y = 0; y < light.height; ++y)
      for (int x = 0; x < light.width; ++x)
        largest = std::max(largest, max_component(light.rgb(x, y)));
  }
  EXPECT_EQ(about(folder)["lightmap"]["rgbm_range"].get<float>(), largest);
}

TEST(Pages, OfOneKeepTheNames) {
  const ScratchFolder s;
  for (const char* options : {"--pages 1", "--pages auto --uv unwrap"}) {
    ASSERT_EQ(bake_for_pages("cornell-box.glb", s.path / "b",
                             std::string("--resolution 64 --samples 4 ") + options)
                  .code,
              0);
    EXPECT_EQ(files_in(s.path / "b"), kBakeFiles);
    EXPECT_EQ(about(s.path / "b")["atlas"]["pages"].size(), 1u);
  }
}

// Folders are compared page by page.
TEST(Pages, FoldersAreCompared) {
  const ScratchFolder s;
  const std::string options = "--resolution 48 --samples 16 --pages 2 --uv unwrap ";
  ASSERT_EQ(bake_for_pages("cornell-box.glb", s.path / "a", options).code, 0);
  ASSERT_EQ(bake_for_pages("cornell-box.glb", s.path / "b", options + "--seed 5").code, 0);
  const auto compare = [&](const char* a, const char* b) {
    const CommandResult r =
        luxel("compare " + (s.path / a).string() + " " + (s.path / b).string() + " --json --quiet");
    EXPECT_EQ(r.code, 0) << r.err;
    return nlohmann::json::parse(r.out);
  };
  EXPECT_EQ(compare("a", "a")["max_abs"], 0);
  const double texels = compare("a", "b")["texels"];
  double by_page = 0;
  for (const char* page : {"lightmap-0.exr", "lightmap-1.exr"}) {
    const nlohmann::json json =
        compare((std::string("a/") + page).c_str(), (std::string("b/") + page).c_str());
    EXPECT_GT(json["rmse"], 0);
    by_page += json["texels"].get<double>();
  }
  EXPECT_EQ(texels, by_page);
}

// The background is one that both show: the preview has a grey of its own where there is none.
TEST(Pages, PreviewIsWhatTheFilesShow) {
  const ScratchFolder s;
  const fs::path folder = s.path / "b", file = s.path / "p.png";
  ASSERT_EQ(bake_for_pages("cornell-box.glb", folder,
                           "--resolution 96 --samples 32 --pages 3 --uv unwrap "
                           "--background 0.1,0.1,0.1")
                .code,
            0);
  const nlohmann::json view = about(folder)["preview"];
  ASSERT_EQ(luxel("render " + scene_file("cornell-box.glb") +
                  " --technique lightmap --quiet --size " + view["width"].dump() + "x" +
                  view["height"].dump() + " --from " + folder.string() + " -o " + file.string())
                .code,
            0);
  const CommandResult r = luxel("compare " + file.string() + " " +
                                (folder / "preview.png").string() + " --json --quiet");
  ASSERT_EQ(r.code, 0) << r.err;
  // One looks texels up in the atlas and leaves out what is empty, the other in the files, whose
  // gutters are filled: they differ at rims of charts.
  EXPECT_GT(nlohmann::json::parse(r.out)["psnr_db"], 40);
}

TEST(Pages, ContradictionsAreASentence) {
  const ScratchFolder s;
  const auto refused = [&](const std::string& options, const std::string& words) {
    const CommandResult r = bake_for_pages("cornell-box.glb", s.path / "b", options);
    EXPECT_EQ(r.code, 1) << options;
    EXPECT_THAT(r.err, HasSubstr(words)) << options;
    EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
  };
  for (const char* pages : {"0", "-1", "2.5", "4097", "many", "''", "1e9"})
    refused(std::string("--pages ") + pages, "--pages '");
  refused("--pages 2 --uv keep", "--uv keep");
  refused("--pages mesh --uv keep", "--uv keep");
  refused("--pages 2 --texels-per-metre 5", "--pages auto");
  refused("--resolution 64 --texels-per-metre 5", "--pages auto");
  refused("--pages mesh --resolution 64 --texels-per-metre 5", "contradict");
  refused("--pages 4 --resolution 16384", "room for 1");
  refused("--pages auto --resolution 16 --texels-per-metre 30 --uv unwrap",
          "raise --resolution to 32");
  EXPECT_EQ(files_in(s.path), std::set<std::string>{});
}

// The limit counts all pages: what one page of as many texels needs, four smaller ones need too.
TEST(Pages, StayUnderTheMemoryThatIsAsked) {
  const ScratchFolder s;
  const CommandResult r = bake_for_pages(
      "cornell-box.glb", s.path / "b", "--resolution 1024 --pages 4 --uv unwrap --max-memory 60M");
  EXPECT_EQ(r.code, 3);
  EXPECT_THAT(r.err, HasSubstr("the smallest that works is"));
}

}  // namespace
}  // namespace luxel::testing_support
