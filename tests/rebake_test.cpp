// --keep: bakes that build on an earlier one give the light of a bake from scratch.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "luxel/export/baked_glb.h"
#include "luxel/scene/shapes.h"
#include "tests/command.h"
#include "tests/pictures.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
namespace fs = std::filesystem;
using Edit = std::function<void(scene::Scene&)>;

/// Instances and materials of room() by number.
constexpr uint32_t kWalls = 0, kBlock = 1, kPanel = 2, kPane = 3;
constexpr uint32_t kPlaster = 0, kPaint = 1, kShine = 2, kGlass = 3;
constexpr size_t kLeft = 0, kRight = 1, kOff = 2;

/// A room without a roof under a grey sky: a painted block, a panel that shines, a pane of coloured
/// glass between them, two lamps, and a third one that is off. The block's corners have few digits:
/// moved by few, its faces stay as large to the last bit, and the atlas the same.
scene::Scene room() {
  scene::Scene scene;
  scene::add_material(scene, "plaster", {0.7f, 0.68f, 0.65f});
  scene::add_material(scene, "paint", {0.15f, 0.5f, 0.2f});
  scene::add_material(scene, "shine", {0.1f, 0.1f, 0.1f}, {3, 2, 1});
  scene::add_material(scene, "glass", {0.9f, 0.4f, 0.3f});
  scene.materials[kGlass].alpha_mode = scene::AlphaMode::blend;
  scene.materials[kGlass].alpha = 0.5f;
  const auto place = [&](std::string name, scene::Mesh mesh) {
    mesh.name = name;
    scene::place(scene, std::move(mesh));
    scene.instances.back().name = std::move(name);
  };
  scene::Mesh walls;
  scene::add_box(walls, {0, 0, 0}, {4, 2.5f, 3}, kPlaster);
  for (auto& triangle : walls.triangles) std::swap(triangle[1], triangle[2]);  // seen from inside
  std::erase_if(walls.triangles, [&](const auto& t) {
    return std::ranges::all_of(t, [&](uint32_t v) { return walls.positions[v].y > 2; });
  });
  walls.triangle_material.resize(walls.triangles.size());
  place("walls", std::move(walls));
  scene::Mesh block, panel, pane;
  scene::add_box(block, {0.5f, 0.0625f, 0.75f}, {1.25f, 0.875f, 1.5f}, kPaint);
  place("block", std::move(block));
  scene::add_box(panel, {3.6f, 0.8f, 1}, {3.65f, 1.4f, 2}, kShine);
  place("panel", std::move(panel));
  scene::add_box(pane, {2.2f, 0.3f, 0.5f}, {2.22f, 1.5f, 2.5f}, kGlass);
  place("pane", std::move(pane));
  for (const auto& [name, x] : {std::pair("left", 0.9f), {"right", 3.0f}, {"off", 2.0f}}) {
    scene::PunctualLight lamp;
    lamp.name = name, lamp.position = {x, 2, 1.7f};
    lamp.intensity = name == std::string("off") ? Rgb{} : Rgb{0.5f, 0.4f, 0.3f};
    scene.lights.push_back(lamp);
  }
  return scene;
}

void move(scene::Scene& scene, uint32_t instance, Vec3 by) {
  Mat34& m = scene.instances[instance].world_from_object;
  m.row[0][3] += by.x, m.row[1][3] += by.y, m.row[2][3] += by.z;
}

/// A bake of room() that is kept, and bakes of what edits make of it.
class Rebake : public ::testing::Test {
 protected:
  const ScratchFolder scratch_;
  const fs::path kept_ = scratch_.path / "kept";
  /// Without leak repair, which cuts charts where the block stands: atlases would differ.
  std::string options_ = " --resolution 64 --samples 64 --no-leak-repair --background 0.4,0.5,0.7";

  fs::path write(const Edit& edit) {
    scene::Scene scene = room();
    edit(scene);
    const auto glb = export_::scene_glb(scene);
    EXPECT_TRUE(glb && write_file_atomically(scratch_.path / "room.glb", *glb));
    return scratch_.path / "room.glb";
  }
  nlohmann::json bake(const Edit& edit, const fs::path& folder, const std::string& more) {
    const CommandResult r = luxel("bake " + write(edit).string() + " -o " + folder.string() +
                                  options_ + " --json " + more);
    EXPECT_EQ(r.code, 0) << r.err;
    err_ = r.err;
    return r.code == 0 ? nlohmann::json::parse(r.out) : nlohmann::json();
  }
  void keep() {
    const nlohmann::json json = bake([](scene::Scene&) {}, kept_, "--keep");
    ASSERT_TRUE(json["cache"]["kept"]) << json["cache"];
  }
  std::string err_;
};

struct RebakeDifference {
  double rms = 0, largest = 0;  ///< relative to the mean
};
RebakeDifference difference_rebake(const fs::path& folder, const fs::path& truth) {
  const image::Image a = lightmap_of(folder), b = lightmap_of(truth);
  EXPECT_EQ(a.width, b.width);
  double sum2 = 0, mean = 0, count = 0, largest = 0;
  for (int y = 0; y < b.height; ++y)
    for (int x = 0; x < b.width; ++x) {
      EXPECT_EQ(a.at(x, y)[3], b.at(x, y)[3]);
      if (b.at(x, y)[3] <= 0) continue;
      const Vec3 d = a.rgb(x, y) - b.rgb(x, y);
      sum2 += double(dot(d, d)) / 3, mean += double(luminance(b.rgb(x, y))), ++count;
      largest = std::max(largest, double(length(d)));
    }
  mean /= count;
  return {std::sqrt(sum2 / count) / mean, largest / mean};
}

/// An edit, and the share of a bake's rays that it may cost.
struct Case {
  const char* name;
  Edit edit;
  double rays = 0;      ///< traced, over those of a bake from scratch: at most
  const char* changed;  ///< in words
  double rms = 0.002;   ///< of the difference, at most
};
/// For the names of tests.
void PrintTo(const Case& p, std::ostream* out) { *out << p.name; }
/// The rms of sums of layers, and of a light that brings most of the light and is supersampled
/// alone.
constexpr double kRough = 0.005;

class RebakeEdits : public Rebake, public ::testing::WithParamInterface<Case> {};

// Atlas and rays are equal, but for what has changed: light differs by the tolerance of the
// bounces, 1e-4 of the mean for each of the two bakes, and at some texels by what supersampling
// does beside what has not changed, or for one lamp alone: it may average over other texels. Sums
// of layers are as good as these (docs/method/layers.md): at 64 samples some tenths of a percent. A
// single texel that only one bake averages is off by a part of the light that a shadow's edge takes
// away.
TEST_P(RebakeEdits, GivesTheLightOfABakeFromScratch) {
  keep();
  const Case& c = GetParam();
  const nlohmann::json again = bake(c.edit, kept_, "--keep");
  const nlohmann::json scratch = bake(c.edit, scratch_.path / "scratch", "");
  EXPECT_TRUE(again["cache"]["built_on"]) << again["cache"];
  EXPECT_EQ(again["cache"]["changed"], c.changed);
  const double rays = scratch["counts"]["rays"].get<double>();
  EXPECT_LE(again["cache"]["rays_traced"].get<double>(), c.rays * rays) << again["cache"];
  const RebakeDifference d = difference_rebake(kept_, scratch_.path / "scratch");
  EXPECT_LT(d.rms, c.rms);
  EXPECT_LT(d.largest, 60 * c.rms);
}

const auto kNothing = [](scene::Scene&) {};

INSTANTIATE_TEST_SUITE_P(
    All, RebakeEdits,
    ::testing::Values(
        Case{"Nothing", kNothing, 0, ""},
        Case{"LampColour",
             [](scene::Scene& s) {
               s.lights[kLeft].intensity = {0.1f, 0.8f, 0};
             },
             0, "light 'left' has another intensity", kRough},
        Case{"LampOff", [](scene::Scene& s) { s.lights[kRight].intensity = {}; }, 0,
             "light 'right' has another intensity", kRough},
        Case{"LampMuchBrighter",
             [](scene::Scene& s) {
               s.lights[kLeft].intensity = {5, 4, 3};
             },
             0.5, "light 'left' has another intensity", kRough},
        Case{"GlassMadeOpaque",
             [](scene::Scene& s) { s.materials[kGlass].alpha_mode = scene::AlphaMode::opaque; },
             0.9, "material 'glass' transmits light differently"},
        Case{"Emission",
             [](scene::Scene& s) {
               s.materials[kShine].emission = {9, 1, 1};
             },
             0, "material 'shine' has another intensity", kRough},
        Case{"LampMoved", [](scene::Scene& s) { s.lights[kLeft].position.z -= 0.8f; }, 0.5,
             "light 'left' shines otherwise"},
        Case{"LampOn",
             [](scene::Scene& s) {
               s.lights[kOff].intensity = {0, 0.2f, 0.6f};
             },
             0.5, "light 'off' shines otherwise"},
        Case{"BlockMoved",
             [](scene::Scene& s) {
               move(s, kBlock, {0.5f, 0, 0.25f});
             },
             0.6, "instance 'block' moved"},
        Case{"PanelMoved",
             [](scene::Scene& s) {
               move(s, kPanel, {-0.3f, 0.2f, 0});
             },
             0.9, "instance 'panel' moved"},
        Case{"PaneMoved",
             [](scene::Scene& s) {
               move(s, kPane, {0.3f, 0, 0});
             },
             0.9, "instance 'pane' moved"},
        Case{"WallsRepainted",
             [](scene::Scene& s) {
               s.materials[kPlaster].base_color = {0.3f, 0.6f, 0.8f};
             },
             0.4, "material 'plaster' has another colour"},
        Case{"GlassRecoloured",
             [](scene::Scene& s) {
               s.materials[kGlass].base_color = {0.2f, 0.5f, 0.9f};
             },
             0.9,
             "material 'glass' transmits light differently, material 'glass' has another colour"},
        Case{"Everything",
             [](scene::Scene& s) {
               move(s, kBlock, {0.5f, 0, 0.25f});
               s.lights[kRight].intensity = {0.9f, 0.1f, 0.1f};
               s.materials[kPlaster].base_color = {0.3f, 0.6f, 0.8f};
             },
             0.7,
             "instance 'block' moved, material 'plaster' has another colour, light 'right' has "
             "another "
             "intensity"}),
    [](const auto& c) { return c.param.name; });

TEST_F(Rebake, KeptBakesAreBakes) {
  keep();
  bake(kNothing, scratch_.path / "plain", "");
  EXPECT_EQ(slurp(kept_ / "lightmap.exr"), slurp(scratch_.path / "plain/lightmap.exr"));
  // Edits start from the bake that was kept, and leave it as it is.
  const std::string light = slurp(kept_ / "cache/light.luxel");
  bake([](scene::Scene& s) { move(s, kBlock, {0.25f, 0, 0.25f}); }, kept_, "--keep");
  EXPECT_EQ(slurp(kept_ / "cache/light.luxel"), light);
  bake(kNothing, kept_, "--keep");
  EXPECT_EQ(slurp(kept_ / "lightmap.exr"), slurp(scratch_.path / "plain/lightmap.exr"));
}

TEST_F(Rebake, ThreadsMakeNoDifference) {
  keep();
  const auto edit = [](scene::Scene& s) { move(s, kBlock, {0.5f, 0, 0.25f}); };
  bake(edit, kept_, "--keep --threads 1");
  const std::string one = slurp(kept_ / "lightmap.exr");
  bake(edit, kept_, "--keep --threads 3");
  EXPECT_EQ(slurp(kept_ / "lightmap.exr"), one);
}

// The sky is what rays see that have escaped; where they went is known.
TEST_F(Rebake, SkyChangesWithoutIt) {
  keep();
  options_ = " --resolution 64 --samples 64 --no-leak-repair --background 0.8,0.3,0.1";
  const nlohmann::json again = bake(kNothing, kept_, "--keep");
  bake(kNothing, scratch_.path / "scratch", "");
  EXPECT_EQ(again["cache"]["changed"], "the surroundings have changed");
  EXPECT_LT(difference_rebake(kept_, scratch_.path / "scratch").rms, 5e-4);
}

TEST_F(Rebake, GoesOnToTheErrorThatIsAskedFor) {
  options_ = " --resolution 64 --max-error 0.1 --no-leak-repair --background 0.4,0.5,0.7";
  keep();
  const auto edit = [](scene::Scene& s) { move(s, kBlock, {0.5f, 0, 0.25f}); };
  const nlohmann::json again = bake(edit, kept_, "--keep");
  EXPECT_TRUE(again["cache"]["built_on"]);
  EXPECT_LE(again["error"]["relative_p95"].get<double>(), 0.1);
  EXPECT_THAT(again["warnings"], IsEmpty());
  const nlohmann::json scratch = bake(edit, scratch_.path / "scratch", "");
  // Each is known to 10 % at 95 of 100 texels, most of them better; which got more rays differs.
  EXPECT_LT(difference_rebake(kept_, scratch_.path / "scratch").rms, 0.05);
}

TEST_F(Rebake, LayersOfAKeptBake) {
  options_ += " --layers per-light";
  keep();
  const auto edit = [](scene::Scene& s) { s.lights[kLeft].intensity = {0.1f, 0.8f, 0}; };
  const nlohmann::json again = bake(edit, kept_, "--keep");
  EXPECT_EQ(again["cache"]["rays_traced"], 0);
  ASSERT_EQ(again["layers"].size(), 4u);  // two lamps, the panel and the sky
  const nlohmann::json scratch = bake(edit, scratch_.path / "scratch", "");
  for (size_t l = 0; l < 4; ++l) {
    const double now = again["layers"][l]["share"], truth = scratch["layers"][l]["share"];
    EXPECT_EQ(again["layers"][l]["name"], scratch["layers"][l]["name"]);
    // A layer is as good as its sparse sweeps, docs/method/layers.md.
    EXPECT_NEAR(now, truth, 0.01) << again["layers"][l];
  }
}

TEST_F(Rebake, AnotherMeshIsBakedFromScratchAndKept) {
  keep();
  const auto edit = [](scene::Scene& s) {
    for (Vec3& p : s.meshes[s.instances[kBlock].mesh].positions) p.y *= 0.5f;
  };
  const nlohmann::json json = bake(edit, kept_, "--keep");
  EXPECT_FALSE(json["cache"]["built_on"]);
  EXPECT_TRUE(json["cache"]["kept"]);
  EXPECT_THAT(json["cache"]["note"], HasSubstr("mesh 'block' has changed"));
  bake(edit, scratch_.path / "scratch", "");
  EXPECT_EQ(slurp(kept_ / "lightmap.exr"), slurp(scratch_.path / "scratch/lightmap.exr"));
  EXPECT_EQ(bake(edit, kept_, "--keep")["cache"]["changed"], "");
}

// Light behind double-sided surfaces decides which of them have two sides; opaque glass stops it.
TEST_F(Rebake, DoubleSidedGlassMadeOpaqueIsBakedFromScratch) {
  const auto two_sided = [](scene::Scene& s) { s.materials[kGlass].double_sided = true; };
  ASSERT_TRUE(bake(two_sided, kept_, "--keep")["cache"]["kept"]);
  const auto edit = [&](scene::Scene& s) {
    two_sided(s);
    s.materials[kGlass].alpha_mode = scene::AlphaMode::opaque;
  };
  EXPECT_THAT(bake(edit, kept_, "--keep")["cache"]["note"],
              HasSubstr("double-sided material 'glass'"));
  bake(edit, scratch_.path / "scratch", "");
  EXPECT_EQ(slurp(kept_ / "lightmap.exr"), slurp(scratch_.path / "scratch/lightmap.exr"));
}

TEST_F(Rebake, OtherSettingsAreNamed) {
  keep();
  options_ += " --seed 2";
  const nlohmann::json json = bake(kNothing, kept_, "--keep");
  EXPECT_FALSE(json["cache"]["built_on"]);
  EXPECT_THAT(json["cache"]["note"], HasSubstr("seed 1 there, 2 here"));
}

TEST_F(Rebake, DamageIsSeen) {
  keep();
  const auto damage = [](const fs::path& file, int places) {
    std::fstream f(file, std::ios::in | std::ios::out | std::ios::binary);
    for (int k = 0; k < places; ++k) {
      f.seekp(std::streamoff(fs::file_size(file) * uintmax_t(2 * k + 1) / uintmax_t(2 * places)));
      f.put('x'), f.put('y');
    }
  };
  const auto edit = [](scene::Scene& s) { move(s, kBlock, {0.5f, 0, 0.25f}); };
  bake(edit, scratch_.path / "scratch", "");
  nlohmann::json json = bake(edit, kept_, "--keep");
  const double intact = json["cache"]["rays_traced"];
  damage(kept_ / "cache/rays.luxel", 12);
  json = bake(edit, kept_, "--keep");
  // Most of the twelve tiles cannot be read, and are traced; they lie in the file in any order.
  EXPECT_GT(json["cache"]["rays_traced"].get<double>(), intact + 10000);
  EXPECT_LT(difference_rebake(kept_, scratch_.path / "scratch").rms, 5e-4);
  fs::resize_file(kept_ / "cache/rays.luxel", 20);
  json = bake(edit, kept_, "--keep");
  EXPECT_THAT(json["cache"]["note"], HasSubstr("rays.luxel is damaged"));
  EXPECT_EQ(json["cache"]["rays_kept"], 0);
  EXPECT_LT(difference_rebake(kept_, scratch_.path / "scratch").rms, 1e-3);
  damage(kept_ / "cache/light.luxel", 1);
  json = bake(edit, kept_, "--keep");
  EXPECT_THAT(json["cache"]["note"], HasSubstr("light.luxel is damaged"));
  EXPECT_TRUE(json["cache"]["kept"]);
  EXPECT_TRUE(bake(edit, kept_, "--keep")["cache"]["built_on"]);
}

TEST_F(Rebake, WhatDoesNotGoTogetherIsRefused) {
  const std::string box = scene_file("cornell-box.glb") + " -o " + (scratch_.path / "b").string();
  for (const auto& [options, why] : {std::pair("--keep --resume", "has no checkpoint"),
                                     {"--keep --time-budget 5", "must not depend on the clock"},
                                     {"--keep --solver reference", "--keep"}}) {
    const CommandResult r = luxel("bake " + box + " " + options);
    EXPECT_NE(r.code, 0) << options;
    EXPECT_THAT(r.err, HasSubstr(why)) << options;
  }
  EXPECT_FALSE(fs::exists(scratch_.path / "b"));
}

TEST_F(Rebake, AFailedBakeLeavesNothing) {
  const CommandResult r = luxel("bake " + write(kNothing).string() + " -o " + kept_.string() +
                                " --keep --max-memory 1M");
  EXPECT_NE(r.code, 0);
  EXPECT_FALSE(fs::exists(kept_));
}

}  // namespace
}  // namespace luxel::testing_support
