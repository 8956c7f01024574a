// Outputs of a bake: complete, the same bits every time, and readable again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "luxel/base/file.h"
#include "luxel/display/tone_map.h"
#include "luxel/export/baked_glb.h"
#include "luxel/image/codec.h"
#include "luxel/import/import.h"
#include "luxel/scene/shapes.h"
#include "tests/command.h"
#include "tests/pictures.h"
#include "tests/surfaces.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

CommandResult bake_for_outputs(const std::string& scene, const std::filesystem::path& output,
                               const std::string& options) {
  return luxel("bake " + scene + " -o " + output.string() + " " + options);
}

TEST(BakeOutputs, AreAllThereAndWhatTheContractSays) {
  const ScratchFolder s;
  const CommandResult r = bake_for_outputs(scene_file("cornell-box.glb"), s.path / "b",
                                           "--resolution 64 --samples 16 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(files_in(s.path / "b"), kBakeFiles);
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json, nlohmann::json::parse(slurp(s.path / "b" / "bake.json")));
  for (const char* key : {"settings", "version", "counts", "seconds", "mrays_per_s",
                          "peak_memory_bytes", "relative_error", "lit_share"})
    EXPECT_TRUE(json.contains(key)) << key;
  for (const char* key : {"triangles", "texels", "rays"}) EXPECT_GT(json["counts"][key], 0) << key;
  EXPECT_GT(json["seconds"]["total"], 0);
  const image::Image map = lightmap_of(s.path / "b");
  ASSERT_EQ(map.channels, 4);
  std::set<float> coverage;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) coverage.insert(map.at(x, y)[3]);
  for (const float a : coverage) EXPECT_TRUE(a == 0 || a == 0.5f || a == 1) << a;
  EXPECT_TRUE(coverage.contains(1));
}

// A lamp of 10 cm hangs 20 cm above the floor of a black hall of 20 m x 20 m: within 2 m lies 99 %
// of its light, or on 1 % of all surface.
TEST(BakeOutputs, StateAnErrorThatSpeaksOfTheLight) {
  const ScratchFolder s;
  std::ofstream(s.path / "night.mtl")
      << "newmtl black\nKd 0 0 0\nnewmtl lamp\nKd 0 0 0\nKe 9 9 9\n";
  std::ofstream(s.path / "night.obj")
      << "mtllib night.mtl\nv -10 0 -10\nv -10 0 10\nv 10 0 10\nv 10 0 -10\n"
         "v -10 3 -10\nv -10 3 10\nv 10 3 10\nv 10 3 -10\n"
         "v -.05 .2 -.05\nv .05 .2 -.05\nv .05 .2 .05\nv -.05 .2 .05\n"
         "usemtl black\nf 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n"
         "usemtl lamp\nf 9 10 11 12\n";
  const CommandResult night =
      bake_for_outputs((s.path / "night.obj").string(), s.path / "n", "--resolution 128");
  ASSERT_EQ(night.code, 0) << night.err;
  EXPECT_THAT(night.err, HasSubstr(" % of the light where there is any ("));
  EXPECT_THAT(night.err, HasSubstr(" % of the texels; RMS, of the finished lightmap)"));
  const auto json = nlohmann::json::parse(slurp(s.path / "n" / "bake.json"));
  EXPECT_LT(json["lit_share"], 0.05);
  EXPECT_LT(json["relative_error_of_lit"], double(json["relative_error"]) / 4);
  const CommandResult box = bake_for_outputs(scene_file("cornell-box.glb"), s.path / "b",
                                             "--resolution 64 --max-error 0.1");
  EXPECT_THAT(box.err, HasSubstr(" % of the mean light (RMS, estimated); 95 % of texels err by"));
}

// Decoded by the formulas of docs/format/bake.md; the bounds are those of its table.
TEST(BakeOutputs, EveryFormatHoldsTheSameLight) {
  const ScratchFolder s;
  const auto folder = s.path / "b";
  ASSERT_EQ(bake_for_outputs(scene_file("cornell-box.glb"), folder,
                             "--resolution 64 --samples 16 --formats rgbe,hdr,rgbm,half,ktx2")
                .code,
            0);
  std::set<std::string> expected = kBakeFiles;
  expected.insert({"lightmap.hdr", "lightmap.rgbm.png", "lightmap.rgbe.png", "lightmap.half.exr",
                   "lightmap.ktx2"});
  EXPECT_EQ(files_in(folder), expected);
  const auto json = nlohmann::json::parse(slurp(folder / "bake.json"));
  EXPECT_EQ(json["files"].get<std::set<std::string>>(), expected);
  const image::Image exr = lightmap_of(folder);
  const image::Image hdr = *image::decode_hdr(*read_file(folder / "lightmap.hdr"), "hdr");
  const image::Image8 m = *image::decode_ldr(*read_file(folder / "lightmap.rgbm.png"), "rgbm");
  const image::Image8 e = *image::decode_ldr(*read_file(folder / "lightmap.rgbe.png"), "rgbe");
  const image::Image half =
      *image::decode_exr(*read_file(folder / "lightmap.half.exr"), "half.exr");
  EXPECT_EQ(json["lightmap"]["half_scale"], 1);
  // A head, and a byte for each texel.
  EXPECT_EQ(std::filesystem::file_size(folder / "lightmap.ktx2"), 192u + 64 * 64);
  const double range = json["lightmap"]["rgbm_range"];
  for (size_t i = 0; i < exr.data.size() / 4; ++i) {
    const double most = double(max_component(exr.rgb(int(i) % 64, int(i) / 64)));
    const double multiplier = range * m.data[4 * i + 3] / 255.0;
    for (size_t c = 0; c < 3; ++c) {
      const double light = double(exr.data[4 * i + c]);
      const double rgbe = std::exp2(e.data[4 * i + 3] - 136.0) * e.data[4 * i + c];
      EXPECT_NEAR(double(hdr.data[3 * i + c]), light, most / 256 * 1.000001);
      EXPECT_EQ(double(hdr.data[3 * i + c]), rgbe);
      EXPECT_NEAR(double(half.data[4 * i + c]), light, light / 2048 + 0x1p-25);
      EXPECT_NEAR(multiplier * m.data[4 * i + c] / 255.0, light,
                  (most + range / 255) / 510 * 1.000001);
    }
  }
}

TEST(BakeOutputs, AFormatThatIsNoneIsSaid) {
  const ScratchFolder s;
  for (const char* formats : {"png", "hdr,", "''", "hdr,exr,Hdr"}) {
    const CommandResult r = bake_for_outputs(scene_file("cornell-box.glb"), s.path / "b",
                                             std::string("--resolution 32 --formats ") + formats);
    EXPECT_EQ(r.code, 1) << formats;
    EXPECT_THAT(r.err, HasSubstr("exr, hdr, rgbm, rgbe, half, ktx2")) << formats;
  }
  EXPECT_EQ(files_in(s.path), std::set<std::string>{});
}

TEST(BakeOutputs, AStageIsALineWhenNobodyWatches) {
  const ScratchFolder s;
  const CommandResult r =
      bake_for_outputs(scene_file("cornell-box.glb"), s.path / "b", "--resolution 32 --samples 4");
  ASSERT_EQ(r.code, 0);
  EXPECT_EQ(r.out, "");
  for (const char* stage : {"import", "packing", "direct light", "trace rays", "bounces", "draw"})
    EXPECT_THAT(r.err, ::testing::ContainsRegex(std::string(stage) + " +[0-9.]+ s")) << stage;
  for (const std::string& name : kBakeFiles)
    EXPECT_THAT(r.err, HasSubstr("wrote " + (s.path / "b" / name).string()));
  EXPECT_EQ(r.err.find('\r'), std::string::npos);
  EXPECT_EQ(r.err.find('\033'), std::string::npos);
}

TEST(BakeOutputs, AreReplacedByTheNextBake) {
  const ScratchFolder s;
  const std::string box = scene_file("cornell-box.glb");
  ASSERT_EQ(bake_for_outputs(box, s.path / "b", "--resolution 32 --samples 4").code, 0);
  ASSERT_EQ(bake_for_outputs(box, s.path / "b", "--resolution 64 --samples 4").code, 0);
  EXPECT_EQ(lightmap_of(s.path / "b").width, 64);
  EXPECT_EQ(files_in(s.path / "b"), kBakeFiles);
}

TEST(BakeOutputs, QuietSaysNothing) {
  const ScratchFolder s;
  const CommandResult r = bake_for_outputs(scene_file("furnace-box.glb"), s.path / "b",
                                           "--resolution 32 --samples 4 --quiet");
  EXPECT_EQ(r.code, 0);
  EXPECT_EQ(r.out + r.err, "");
}

// A white background of radiance 1 over a plate that sees nothing else: E = pi on its front.
TEST(BakeOutputs, ALonePlateUnderAWhiteSkyReceivesPi) {
  const ScratchFolder s;
  const auto file = s.write("plate.obj", "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nf 1 2 3 4\n");
  ASSERT_EQ(bake_for_outputs(file.string(), s.path / "b",
                             "--resolution 16 --samples 8 --background 1,1,1")
                .code,
            0);
  const image::Image map = lightmap_of(s.path / "b");
  int covered = 0;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      if (map.at(x, y)[3] == 1) {
        EXPECT_NEAR(map.rgb(x, y).x, kPi, 1e-5f);
        ++covered;
      }
  EXPECT_GT(covered, 20);
}

/// World triangles, each as its nine coordinates rounded to a micrometre, as a multiset.
std::multiset<std::array<long, 9>> triangles_of(const scene::Scene& scene) {
  std::multiset<std::array<long, 9>> out;
  const auto micro = [](float v) { return std::lround(double(v) * 1e6); };
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t) {
      const scene::Triangle3 w = scene::world_triangle(scene, i, t);
      out.insert({micro(w.a.x), micro(w.a.y), micro(w.a.z), micro(w.b.x), micro(w.b.y),
                  micro(w.b.z), micro(w.c.x), micro(w.c.y), micro(w.c.z)});
    }
  return out;
}

TEST(BakedGlb, ReadsBackWithTheSameTrianglesAndBakesAgain) {
  for (const char* name : {"cornell-box.glb", "spheres-and-cube.glb"}) {
    const ScratchFolder s;
    ASSERT_EQ(bake_for_outputs(scene_file(name), s.path / "b", "--resolution 128 --samples 8").code,
              0);
    const auto original = import::import_scene(scene_file(name));
    const auto baked = import::import_scene(s.path / "b" / "baked.glb");
    ASSERT_TRUE(baked) << baked.error().message;
    EXPECT_EQ(triangles_of(original->scene), triangles_of(baked->scene)) << name;
    for (const scene::Mesh& mesh : baked->scene.meshes) {
      ASSERT_EQ(mesh.uv1.size(), mesh.positions.size());
      for (const Vec2& uv : mesh.uv1) EXPECT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
    }
    const CommandResult again =
        bake_for_outputs((s.path / "b" / "baked.glb").string(), s.path / "again",
                         "--uv keep --resolution 128 --samples 8");
    EXPECT_EQ(again.code, 0) << again.err;
  }
}

// The lightmap takes TEXCOORD_1; a texture that looked at the scene's second set finds that in
// TEXCOORD_2.
TEST(BakedGlb, ReadsBackASecondSetOfTextureCoordinates) {
  const ScratchFolder s;
  scene::Scene sheet;
  sheet.meshes.resize(1), sheet.instances.resize(1), sheet.materials.resize(1);
  scene::Mesh& mesh = sheet.meshes[0];
  mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}};
  mesh.uv0 = {{0, 0}, {0, 0}, {0, 0}, {0, 0}};
  mesh.uv1 = {{0.3f, 0}, {0.3f, 0}, {0.9f, 0}, {0.9f, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}}, mesh.triangle_material = {0, 0};
  sheet.textures.resize(1);
  sheet.textures[0].width = 4, sheet.textures[0].height = 1;
  sheet.textures[0].rgba = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 99, 99, 99, 255};
  sheet.materials[0].base_color_texture.texture = 0;
  sheet.materials[0].base_color_texture.uv_set = 1;
  const auto glb = export_::scene_glb(sheet);
  ASSERT_TRUE(glb && write_file_atomically(s.path / "sheet.glb", *glb));
  ASSERT_EQ(
      bake_for_outputs((s.path / "sheet.glb").string(), s.path / "b", "--resolution 16 --samples 1")
          .code,
      0);
  const auto baked = import::import_scene(s.path / "b" / "baked.glb");
  ASSERT_TRUE(baked) << baked.error().message;
  using Seen = std::map<std::array<long, 3>, Rgb>;  // colour by place [1e-6 m]
  const auto seen = [](const scene::Scene& scene) {
    Seen out;
    for (uint32_t t = 0; t < 2; ++t)
      for (const Vec2 uv : {Vec2{0.2f, 0.1f}, Vec2{0.1f, 0.5f}, Vec2{0.3f, 0.3f}}) {
        const scene::SurfacePoint p{0, t, {uv.x, uv.y}};
        const Vec3 at = scene::world_position(scene, p);
        out[{std::lround(1e6f * at.x), 0, std::lround(1e6f * at.z)}] =
            scene::reflectance_at(scene, p);
      }
    return out;
  };
  const Seen before = seen(sheet), after = seen(baked->scene);
  ASSERT_EQ(before.size(), 6u);
  for (const auto& [place, color] : before) {
    ASSERT_TRUE(after.contains(place));
    EXPECT_LT(length(after.at(place) - color), 1e-5f);
  }
}

// A deck with open air below and a wall on it, four triangles of a double-sided material: each gets
// a back, and the deck is cut under the wall. Three vertices on it, two of them on its outline,
// make 2 * 7 - 2 - 6 = 6 triangles of the deck by Euler's formula, the one in its midst 3 of the
// wall.
TEST(BakedGlb, SaysWhyItHasMoreTriangles) {
  scene::Scene scene;
  const uint32_t wood = scene::add_material(scene, "wood", {0.5f, 0.5f, 0.5f});
  scene.materials[wood].double_sided = true;
  scene::Mesh mesh;
  scene::add_quad(mesh, {Vec3{-2, 1, 2}, {2, 1, 2}, {2, 1, -2}, {-2, 1, -2}}, wood);
  scene::add_quad(mesh, {Vec3{-2, 1, 0.3f}, {2, 1, 0.3f}, {2, 2, 0.3f}, {-2, 2, 0.3f}}, wood);
  scene::place(scene, std::move(mesh));
  const ScratchFolder s;
  ASSERT_TRUE(write_file_atomically(s.path / "deck.glb", *export_::scene_glb(scene)));
  const CommandResult r =
      bake_for_outputs((s.path / "deck.glb").string(), s.path / "b", "--resolution 64 --samples 4");
  ASSERT_EQ(r.code, 0) << r.err;
  const nlohmann::json counts = nlohmann::json::parse(slurp(s.path / "b" / "bake.json"))["counts"];
  const auto baked = import::import_scene(s.path / "b" / "baked.glb");
  const size_t all = scene::first_triangles(baked->scene).back();
  EXPECT_EQ(all, 2u * (6 + 3));
  EXPECT_EQ(testing_support::count_t_junctions(testing_support::triangles_of(baked->scene)), 0u);
  EXPECT_EQ(counts["triangles"], all);
  EXPECT_EQ(counts["triangles_of_file"], 4);
  EXPECT_EQ(counts["backs"], all / 2);
  const double times = double(all) / 4;
  EXPECT_THAT(r.err,
              HasSubstr(fmt::format("{} triangles, {:.1f} times the file's 4 (2.0 by backs of "
                                    "thin surfaces, {:.1f} by cuts",
                                    all, times, times / 2)));
}

// Read back and drawn without a lightmap, both ways of attaching light show what preview.png shows:
// the first is the picture itself, the second linear light for the tone curve. Steps of 8 bits, and
// interpolation after the tone curve instead of before, and look-ups at rims, with gutter in them.
TEST(BakedGlb, ShowsItsLightToThoseWhoKnowNoLightmap) {
  const ScratchFolder s;
  for (const char* attach : {"combined", "emissive"}) {
    SCOPED_TRACE(attach);
    const auto folder = s.path / attach;
    ASSERT_EQ(bake_for_outputs(scene_file("cornell-box.glb"), folder,
                               std::string("--resolution 128 --samples 16 --attach ") + attach)
                  .code,
              0);
    const bool combined = std::string_view(attach) == "combined";
    const auto drawn = folder / "drawn.exr";
    const CommandResult r =
        luxel("render " + (folder / "baked.glb").string() + " --size 720x720 -o " + drawn.string() +
              (combined ? " --technique c" : " --technique path --bounces 0 --samples 4"));
    ASSERT_EQ(r.code, 0) << r.err;
    image::Image picture = exr_at(drawn);
    const image::Image8 shown = display::tone_map(
        picture, 1, combined ? display::ToneMap::clamp : display::ToneMap::shoulder);
    const image::Image8 preview =
        *image::decode_ldr(*read_file(folder / "preview.png"), "preview.png");
    ASSERT_EQ(preview.width, picture.width);
    double sum = 0, pixels = 0;
    for (size_t i = 0; i < size_t(picture.width) * size_t(picture.height); ++i) {
      if (picture.data[4 * i + 3] < 1) continue;  // the box's own rim, and what is behind
      for (size_t c = 0; c < 3; ++c)
        sum += std::abs(int(shown.data[3 * i + c]) - int(preview.data[4 * i + c]));
      pixels += 3;
    }
    EXPECT_GT(pixels, 720 * 720);
    std::printf("%s: mean difference %.3f of 255\n", attach, sum / pixels);
    EXPECT_LT(sum / pixels, combined ? 1 : 2);
    const CommandResult from = luxel("render " + scene_file("cornell-box.glb") + " --from " +
                                     folder.string() + " -o " + (s.path / "x.png").string());
    EXPECT_EQ(from.code, 1);
    EXPECT_THAT(from.err, HasSubstr(std::string("--attach ") + attach));
  }
}

TEST(BakeOutputs, LightIsAttachedInOneWay) {
  const ScratchFolder s;
  const CommandResult r =
      bake_for_outputs(scene_file("cornell-box.glb"), s.path / "b",
                       "--solver hemicube --vertex-colors --attach combined --resolution 32");
  EXPECT_EQ(r.code, 1);
  EXPECT_THAT(r.err, HasSubstr("--vertex-colors"));
  EXPECT_EQ(files_in(s.path), std::set<std::string>{});
}

// Baked light is diffuse: highlights of the local techniques stay out of it.
TEST(BakedGlb, HasNoHighlights) {
  const ScratchFolder s;
  ASSERT_THAT(slurp(scene_file("spheres-and-cube.glb")), HasSubstr("KHR_materials_specular"));
  ASSERT_EQ(bake_for_outputs(scene_file("spheres-and-cube.glb"), s.path / "b",
                             "--resolution 64 --samples 1")
                .code,
            0);
  EXPECT_THAT(slurp(s.path / "b" / "baked.glb"),
              ::testing::Not(HasSubstr("KHR_materials_specular")));
}

TEST(Render, DrawsABake) {
  const ScratchFolder s;
  const std::string box = scene_file("cornell-box.glb");
  ASSERT_EQ(bake_for_outputs(box, s.path / "b", "--resolution 64 --samples 8").code, 0);
  for (const char* name : {"x.png", "x.exr"}) {
    const CommandResult r = luxel("render " + box + " --from " + (s.path / "b").string() + " -o " +
                                  (s.path / name).string() + " --size 64x48");
    EXPECT_EQ(r.code, 0) << r.err;
  }
  const auto exr = read_file(s.path / "x.exr");
  const image::Image picture = *image::decode_exr(*exr, "x.exr");
  EXPECT_EQ(picture.width, 64);
  double sum = 0;
  for (const float v : picture.data) sum += double(v);
  EXPECT_GT(sum / double(picture.data.size()), 0.05);
  EXPECT_EQ(luxel("render " + box + " --from " + (s.path / "none").string() + " -o x.png").code, 1);
  EXPECT_EQ(luxel("render " + box + " --from " + (s.path / "b").string() + " -o x.bmp").code, 1);
  EXPECT_THAT(luxel("render " + box + " --camera none --from " + (s.path / "b").string() + " -o " +
                    (s.path / "y.png").string())
                  .err,
              HasSubstr("--camera none"));
}

TEST(Render, TracesPathsWithoutABake) {
  const ScratchFolder s;
  const std::string command =
      "render " + scene_file("cornell-box.glb") + " --technique path --size 32x24 --samples 16 -o ";
  const CommandResult png = luxel(command + (s.path / "x.png").string());
  EXPECT_EQ(png.code, 0) << png.err;
  EXPECT_THAT(png.err, HasSubstr("standard error"));
  const CommandResult exr = luxel(command + (s.path / "x.exr").string() + " --json --threads 1");
  EXPECT_EQ(exr.code, 0) << exr.err;
  const auto json = nlohmann::json::parse(exr.out);
  EXPECT_GT(json["relative_error"], 0.01);
  EXPECT_LT(json["relative_error"], 1);
  EXPECT_GT(json["rays"], 32 * 24 * 16);
  ASSERT_EQ(luxel(command + (s.path / "y.exr").string() + " --threads 2").code, 0);
  EXPECT_EQ(slurp(s.path / "x.exr"), slurp(s.path / "y.exr"));
  // Half of the pixels see the lit box: 0.1 is a dim room, 17 the lamp itself.
  const image::Image picture = exr_at(s.path / "x.exr");
  double sum = 0;
  for (const float v : picture.data) sum += double(v);
  EXPECT_GT(sum / double(picture.data.size()), 0.1);
}

TEST(Render, SaysWhatATechniqueNeeds) {
  const ScratchFolder s;
  const std::string command =
      "render " + scene_file("cornell-box.glb") + " -o " + (s.path / "x.png").string();
  const CommandResult without = luxel(command);
  EXPECT_EQ(without.code, 1);
  EXPECT_THAT(without.err, HasSubstr("--from"));
  const CommandResult with = luxel(command + " --technique path --from " + s.path.string());
  EXPECT_EQ(with.code, 1);
  EXPECT_THAT(with.err, HasSubstr("--from"));
  const CommandResult none = luxel(command + " --technique path --samples 0");
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.err, HasSubstr("--samples 0"));
  EXPECT_EQ(files_in(s.path), std::set<std::string>{});
}

// Two solvers that share no line of light transport leave nearly the same lightmap.
TEST(BakeWithTheReference, AgreesWithGather) {
  const ScratchFolder s;
  const std::string scene = scene_file("spheres-and-cube.glb");
  ASSERT_EQ(bake_for_outputs(scene, s.path / "g", "--resolution 64 --samples 256").code, 0);
  const CommandResult r =
      bake_for_outputs(scene, s.path / "r", "--resolution 64 --samples 256 --solver reference");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr(" % of the mean light (RMS, estimated)"));
  const auto json = nlohmann::json::parse(slurp(s.path / "r" / "bake.json"));
  EXPECT_EQ(json["settings"]["solver"], "reference");
  const image::Image a = lightmap_of(s.path / "g");
  const image::Image b = lightmap_of(s.path / "r");
  ASSERT_EQ(a.data.size(), b.data.size());
  double sum = 0, difference2 = 0, n = 0;
  for (size_t i = 0; i < a.data.size(); i += 4) {
    if (a.data[i + 3] < 1) continue;
    const double d = double(a.data[i + 1]) - double(b.data[i + 1]);
    sum += double(a.data[i + 1]), difference2 += d * d, ++n;
  }
  // The paths' own noise, and as much again for gather's and for its texels.
  const double relative = std::sqrt(difference2 / n) / (sum / n);
  EXPECT_LT(relative, 2 * double(json["relative_error"]));
}

TEST(SameBits, WithAnyNumberOfThreads) {
  const ScratchFolder s;
  const std::string options = "--resolution 128 --samples 64 --uv unwrap ";
  const std::string scene = scene_file("spheres-and-cube.glb");
  ASSERT_EQ(bake_for_outputs(scene, s.path / "1", options + "--threads 1").code, 0);
  ASSERT_EQ(bake_for_outputs(scene, s.path / "2", options + "--threads 2").code, 0);
  EXPECT_EQ(slurp(s.path / "1" / "lightmap.exr"), slurp(s.path / "2" / "lightmap.exr"));
  EXPECT_EQ(slurp(s.path / "1" / "baked.glb"), slurp(s.path / "2" / "baked.glb"));
}

/// The smallest --max-memory that is said to work.
std::string least_memory(const std::string& scene, const std::filesystem::path& folder,
                         const std::string& options) {
  const CommandResult refused =
      bake_for_outputs(scene, folder / "none", options + "--max-memory 1M");
  const size_t at = refused.err.find("that works is ");
  if (at == std::string::npos) return refused.err;
  return refused.err.substr(at + 14, refused.err.find('\n', at) - at - 14);
}

// At the smallest memory that is advised, hits go to the disk.
TEST(SameBitsSlow, WithHitsOnTheDisk) {
  const ScratchFolder s;
  const std::string options = "--resolution 256 --samples 256 ";
  const std::string scene = scene_file("cornell-box.glb");
  const std::string least = least_memory(scene, s.path, options);
  ASSERT_EQ(bake_for_outputs(scene, s.path / "memory", options).code, 0);
  ASSERT_EQ(bake_for_outputs(scene, s.path / "disk", options + "--max-memory " + least).code, 0)
      << least;
  const auto json = nlohmann::json::parse(slurp(s.path / "disk" / "bake.json"));
  EXPECT_GT(json["scratch_bytes"], 1 << 20) << least;
  EXPECT_EQ(slurp(s.path / "memory" / "lightmap.exr"), slurp(s.path / "disk" / "lightmap.exr"));
  EXPECT_EQ(files_in(s.path), (std::set<std::string>{"memory", "disk"}));
}

// Memory per texel outweighs the rest of the process by far here.
TEST(MaxMemorySlow, TheLeastThatWorksIsKept) {
  const std::string scene = scene_file("cornell-box.glb");
  for (const char* more : {"", "--denoise ", "--keep "}) {
    const ScratchFolder s;
    const std::string options = std::string("--resolution 1024 --samples 4 ") + more;
    const std::string least = least_memory(scene, s.path, options);
    ASSERT_EQ(bake_for_outputs(scene, s.path / "baked", options + "--max-memory " + least).code, 0)
        << least;
    const auto json = nlohmann::json::parse(slurp(s.path / "baked" / "bake.json"));
    // A tenth: what allocators keep, and buffers of threads.
    EXPECT_LT(double(json["peak_memory_bytes"]), 1.1 * double(json["settings"]["max_memory_bytes"]))
        << options;
  }
}

// A map whose texels lie in files has the bits of one in memory, which takes more of it.
TEST(MaxMemorySlow, LargeMapsLieInFiles) {
  const ScratchFolder s;
  const std::string scene = scene_file("cornell-box.glb");
  const std::string options =
      "--resolution 3072 --samples 2 --direct-samples 1 --supersample 1 --bounces 1 ";
  const std::string least = least_memory(scene, s.path, options);
  ASSERT_EQ(bake_for_outputs(scene, s.path / "memory", options).code, 0);
  ASSERT_EQ(bake_for_outputs(scene, s.path / "files", options + "--max-memory " + least).code, 0)
      << least;
  for (const char* file : {"lightmap.exr", "baked.glb", "preview.png"})
    EXPECT_EQ(slurp(s.path / "memory" / file), slurp(s.path / "files" / file)) << file;
  const auto json = nlohmann::json::parse(slurp(s.path / "files" / "bake.json"));
  // Texels, elements and what their rays brought: 92 bytes.
  EXPECT_GT(json["scratch_bytes"], 92 * json["counts"]["texels"].get<uint64_t>());
  // A tenth, as above.
  EXPECT_LT(double(json["peak_memory_bytes"]), 1.1 * double(json["settings"]["max_memory_bytes"]));
}

}  // namespace
}  // namespace luxel::testing_support
