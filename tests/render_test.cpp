// Every technique of `luxel render`, the sheet of all of them, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/image/codec.h"
#include "tests/command.h"
#include "tests/pictures.h"

namespace luxel::testing_support {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A grey plate (0.5) that faces +z, seen from 2 m by a camera that looks at its middle.
struct Plate {
  ScratchFolder s;
  std::string command(const std::string& options, const std::string& output) const {
    s.write("paint.mtl", "newmtl paint\nKd 0.5 0.5 0.5\nKs 0.25 0.25 0.25\nNs 10\n");
    const auto scene = s.write("plate.obj",
                               "mtllib paint.mtl\nusemtl paint\n"
                               "v -5 -5 0\nv 5 -5 0\nv 5 5 0\nv -5 5 0\nf 1 2 3 4\n");
    const std::string size = options.find("--size") == std::string::npos ? " --size 33x33 " : " ";
    return "render " + scene.string() + " --eye 0,0,2 --look-at 0,0,0 " + options + size + "-o " +
           (s.path / output).string();
  }
  image::Image draw(const std::string& options) const {
    const CommandResult r = luxel(command(options, "x.exr"));
    EXPECT_EQ(r.code, 0) << options << ": " << r.err;
    const image::Image picture = exr_at(s.path / "x.exr");
    return picture.width > 1 ? picture : image::Image(33, 33, 4);
  }
  float middle(const std::string& options) const { return draw(options).rgb(16, 16).y; }
};

// Ambient 0.1 and, with a sun behind the viewer, light 0.8 that faces the plate; 45 degrees from
// above it is cos 45 of that. The closed forms of luxel/display/local_light_test.cpp, from outside.
TEST(Techniques, LocalLightOnAPlate) {
  const Plate plate;
  EXPECT_NEAR(plate.middle("--technique c"), 0.5f, 1e-5f);
  EXPECT_NEAR(plate.middle("--technique ca"), 0.05f, 1e-5f);
  // The sun's azimuth 180 is +z: it stands behind the viewer.
  const std::string facing = " --sun 180,0,1", above = " --sun 180,45,1";
  EXPECT_NEAR(plate.middle("--technique cad" + facing), 0.05f + 0.4f, 1e-5f);
  EXPECT_NEAR(plate.middle("--technique cad" + above), 0.05f + 0.4f * std::sqrt(0.5f), 1e-5f);
  EXPECT_NEAR(plate.middle("--technique cas-pixel" + facing), 0.05f + 0.2f, 1e-4f);
  EXPECT_NEAR(plate.middle("--technique cads-pixel" + facing), 0.05f + 0.4f + 0.2f, 1e-4f);
  // At the corners V leans by cos = 2 / sqrt(54): the highlight there is nothing, and the middle of
  // a quad is on the edge between two of them.
  const float corner = 0.2f * std::pow(2 / std::sqrt(54.0f), 10.0f);
  EXPECT_NEAR(plate.middle("--technique cas" + facing), 0.05f + corner, 1e-5f);
  EXPECT_NEAR(plate.middle("--technique cads" + facing), 0.45f + corner, 1e-5f);
}

TEST(Techniques, NormalsAreDrawn) {
  const ScratchFolder s;
  ASSERT_EQ(luxel("render " + scene_file("spheres-and-cube.glb") +
                  " --technique normals --size 200x200 -o " + (s.path / "n.png").string())
                .code,
            0);
  const auto png = *image::decode_ldr(*read_file(s.path / "n.png"), "n.png");
  int red = 0;
  for (size_t i = 0; i < png.data.size(); i += 4)
    red += png.data[i] > 150 && png.data[i + 1] < 80 ? 1 : 0;
  EXPECT_GT(red, 100);
}

TEST(Techniques, LightIsWrittenToHdrAndExrAlike) {
  const Plate plate;
  const std::string options = "--technique path --samples 4 --background 1,1,1 ";
  const image::Image exr = plate.draw(options);
  ASSERT_EQ(luxel(plate.command(options, "x.hdr")).code, 0);
  const image::Image hdr = *image::decode_hdr(*read_file(plate.s.path / "x.hdr"), "x.hdr");
  ASSERT_EQ(hdr.width, exr.width);
  // Half of a white sky: 0.5, whatever the paths do.
  EXPECT_NEAR(exr.rgb(16, 16).x, 0.5f, 1e-5f);
  EXPECT_NEAR(hdr.rgb(16, 16).x, 0.5f, 0.5f / 128);
}

/// The middle of the picture as a screen shows it.
int shown(const Plate& plate, const std::string& options) {
  const CommandResult r = luxel(plate.command(options, "x.png"));
  EXPECT_EQ(r.code, 0) << options << ": " << r.err;
  const auto png = *image::decode_ldr(*read_file(plate.s.path / "x.png"), "x.png");
  return png.data[4 * (16 * 33 + 16)];
}

TEST(ToneMapping, ExposureAndCurvesAreThoseOfTheirNames) {
  const Plate plate;
  const auto srgb = [](double v) {
    return int(
        std::round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055)));
  };
  // A radiance of 0.125 everywhere.
  const std::string light = "--technique path --samples 1 --background 0.25,0.25,0.25 ";
  EXPECT_NEAR(shown(plate, light + "--tone-map clamp --exposure 0"), srgb(0.125), 1);
  EXPECT_NEAR(shown(plate, light + "--tone-map clamp --exposure +1"), srgb(0.25), 1);
  EXPECT_NEAR(shown(plate, light + "--tone-map clamp --exposure -1.0"), srgb(0.0625), 1);
  EXPECT_NEAR(shown(plate, light + "--tone-map clamp"), srgb(0.6), 1) << "automatic";
  EXPECT_NEAR(shown(plate, light + "--tone-map clamp --exposure auto:50"), srgb(0.6), 1);
  EXPECT_NEAR(shown(plate, light + "--tone-map ratio --exposure 3"), srgb(0.5), 1);
  EXPECT_NEAR(shown(plate, light + "--tone-map reinhard --exposure 3"), srgb(0.53125), 1);
  EXPECT_NEAR(shown(plate, light + "--tone-map reinhard --exposure 5"), 255, 1);
  EXPECT_NEAR(shown(plate, light + "--tone-map filmic --exposure 3"), srgb(2.54 / 3.16), 1);
  EXPECT_NEAR(shown(plate, light + "--tone-map shoulder --exposure 1"), srgb(0.25), 1);
  // Colours of a screen are shown as they are, unless it is said otherwise.
  EXPECT_NEAR(shown(plate, "--technique c"), srgb(0.5), 1);
  EXPECT_NEAR(shown(plate, "--technique ca --exposure 1"), srgb(0.1), 1);
}

TEST(ContactSheetCommand, HoldsAllTechniquesOfAScene) {
  const ScratchFolder s;
  const CommandResult r = luxel("render " + scene_file("cornell-box.glb") +
                                " --technique all --size 64x48 --samples 4 --hemicube 8" +
                                " --max-elements 200 --json -o " + (s.path / "sheet.png").string());
  ASSERT_EQ(r.code, 0) << r.err;
  const auto json = nlohmann::json::parse(r.out);
  for (const char* name : {"c", "ca", "cad", "cas", "cads", "cas-pixel", "cads-pixel", "normals",
                           "radiosity", "lightmap", "path"})
    EXPECT_THAT(json["tiles"].get<std::vector<std::string>>(), ::testing::Contains(name));
  const auto png = *image::decode_ldr(*read_file(s.path / "sheet.png"), "sheet.png");
  EXPECT_EQ(png.width, json["width"]);
  EXPECT_GT(png.width * png.height, 10 * 64 * 48);
  EXPECT_EQ(files_in(s.path), std::set<std::string>{"sheet.png"});
}

TEST(ContactSheetCommand, DrawsTheBakeThatItIsGiven) {
  const ScratchFolder s;
  const std::string furnace = scene_file("furnace-box.glb");
  ASSERT_EQ(
      luxel("bake " + furnace + " -o " + (s.path / "b").string() + " --resolution 32 --samples 4")
          .code,
      0);
  const std::string command = "render " + furnace +
                              " --technique all --size 32x24 --samples 1 --hemicube 8" +
                              " --max-elements 200 -o " + (s.path / "x.png").string() + " --from ";
  const CommandResult with = luxel(command + (s.path / "b").string());
  EXPECT_EQ(with.code, 0) << with.err;
  EXPECT_EQ(with.err.find("packing"), std::string::npos) << "no second bake";
  const CommandResult missing = luxel(command + (s.path / "none").string());
  EXPECT_EQ(missing.code, 1);
  EXPECT_THAT(missing.err, HasSubstr("none"));
}

/// A bake's texels on the plate: one of the two grays of the checker, as it faces the eye. From a
/// folder and from a small bake of its own.
TEST(Techniques, TexelsAreDrawnFromABakeOrWithoutOne) {
  const Plate plate;
  const auto linear = [](float v) { return std::pow((v / 255 + 0.055f) / 1.055f, 2.4f); };
  const auto is_gray = [&](float v) {
    return std::abs(v - linear(205)) < 1e-3f || std::abs(v - linear(160)) < 1e-3f;  // 8 bits
  };
  const float quick = plate.draw("--technique texels").rgb(4, 4).y;
  EXPECT_TRUE(is_gray(quick)) << quick;
  const std::string dir = (plate.s.path / "b").string();
  const std::string bake = "bake " + (plate.s.path / "plate.obj").string() + " -o " + dir +
                           " --resolution 64 --samples 4 --quiet";
  ASSERT_EQ(luxel(bake).code, 0);
  const CommandResult without = luxel(plate.command("--technique texels --from " + dir, "x.exr"));
  EXPECT_EQ(without.code, 1);
  EXPECT_THAT(without.err, HasSubstr("--texels"));
  ASSERT_EQ(luxel(bake + " --texels").code, 0);
  const float from = plate.draw("--technique texels --from " + dir).rgb(4, 4).y;
  EXPECT_TRUE(is_gray(from)) << from;
}

// Behind the eye there is nothing but the background that the bake had. An option of one's own
// wins, and a picture of the sky that is gone is said to be.
TEST(Techniques, ABakeIsDrawnUnderItsOwnSky) {
  const ScratchFolder s;
  const auto scene = s.write("plate.obj", "v -5 -5 0\nv 5 -5 0\nv 5 5 0\nv -5 5 0\nf 1 2 3 4\n");
  const auto baked = [&](const std::string& light) {
    ASSERT_EQ(luxel("bake " + scene.string() + " -o " + (s.path / "b").string() +
                    " --resolution 16 --samples 4 --quiet " + light)
                  .code,
              0);
  };
  const auto away = [&](const std::string& options) {
    return luxel("render " + scene.string() + " --from " + (s.path / "b").string() +
                 " --eye 0,0,2 --look-at 0,0,4 --size 9x9 -o " + (s.path / "x.exr").string() + " " +
                 options);
  };
  baked("--background 0.25,0.5,1");
  ASSERT_EQ(away("").code, 0);
  EXPECT_EQ(exr_at(s.path / "x.exr").rgb(4, 4), (Rgb{0.25f, 0.5f, 1}));
  ASSERT_EQ(away("--background 2,1,1").code, 0);
  EXPECT_EQ(exr_at(s.path / "x.exr").rgb(4, 4), (Rgb{2, 1, 1}));
  // A sky, and the one that a scene without light gets: both look the same as when asked for again.
  for (const auto& [of_bake, the_same] :
       {std::pair{"--sky 200,30", "--sky 200,30"}, {"", "--sky 135,40"}}) {
    baked(of_bake);
    ASSERT_EQ(away("").code, 0);
    const image::Image kept = exr_at(s.path / "x.exr");
    ASSERT_EQ(away(the_same).code, 0);
    EXPECT_TRUE(kept.data == exr_at(s.path / "x.exr").data) << of_bake;
    EXPECT_GT(kept.rgb(4, 4).z, 100) << "cd/m^2";
  }
  image::Image sky(8, 4, 3);
  std::fill(sky.data.begin(), sky.data.end(), 3.0f);
  const auto map = s.path / "sky.exr";
  const auto bytes = *image::encode_exr(sky);
  s.write("sky.exr", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  baked("--environment " + map.string());
  ASSERT_EQ(away("").code, 0);
  EXPECT_EQ(exr_at(s.path / "x.exr").rgb(4, 4), (Rgb{3, 3, 3}));
  std::filesystem::remove(map);
  const CommandResult gone = away("");
  EXPECT_EQ(gone.code, 0);
  EXPECT_THAT(gone.err, HasSubstr("sky.exr of the bake no longer exists"));
}

TEST(RenderRefuses, WhatATechniqueWouldNotLookAt) {
  const Plate plate;
  const auto refused = [&](const std::string& options, const std::string& option,
                           const std::string& output = "x.png") {
    const CommandResult r = luxel(plate.command(options, output));
    EXPECT_EQ(r.code, 1) << options;
    EXPECT_THAT(r.err, AllOf(HasSubstr("luxel: "), HasSubstr(option))) << options;
    EXPECT_FALSE(std::filesystem::exists(plate.s.path / output)) << options;
  };
  const std::string bake = " --from " + plate.s.path.string();
  refused("--technique lightmap --samples 9" + bake, "leave --samples out");
  refused("--technique lightmap --bounces 1" + bake, "leave --bounces out");
  refused("--technique lightmap --seed 1" + bake, "leave --seed out");
  refused("--technique lightmap --sun 1,2,3" + bake, "luxel bake");
  refused("--technique lightmap", "--from");
  for (const char* name : {"c", "cads-pixel", "normals", "path"})
    refused("--technique " + std::string(name) + bake, "leave --from out");
  refused("--technique cad --samples 9", "leave --samples out");
  refused("--technique c --sun 1,2,3", "leave --sun out");
  refused("--technique normals --sun 1,2,3", "leave --sun out");
  refused("--technique c --exposure 1", "leave it out", "x.exr");
  refused("--technique c --tone-map clamp", "leave it out", "x.hdr");
  refused("--technique all", ".png", "x.exr");
  refused("--technique all --size 4000x4000", "--size 4000x4000");
  refused("--technique c --exposure bright", "--exposure 'bright'");
  refused("--technique c --exposure auto:101", "auto:101");
  refused("--technique c --exposure 1e9", "1e9");
  refused("--technique c --tone-map aces", "filmic");
  refused("--technique c --size 0x4", "--size 0x4");
}

TEST(RenderRefuses, UnknownTechniquesWithTheListOfThem) {
  const Plate plate;
  const CommandResult r = luxel(plate.command("--technique phong", "x.png"));
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("cads-pixel"));
}

}  // namespace
}  // namespace luxel::testing_support
