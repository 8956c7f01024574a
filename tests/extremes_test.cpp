// Scenes at the ends of what single precision holds (luxel/scene/held_range.h), and beyond them.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/scene/procedural.h"
#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

/// Lamps of the box besides its own.
scene::Scene box_with_lamps() {
  scene::Scene box = scene::cornell_box();
  scene::PunctualLight lamp{"bulb", scene::PunctualLight::Kind::point, {0.1f, 0.1f, 0.1f}};
  lamp.position = {0.1f, 0.4f, 0.3f};
  box.lights.push_back(lamp);
  lamp.name = "spot", lamp.kind = scene::PunctualLight::Kind::spot;
  lamp.position = {0.4f, 0.5f, 0.1f}, lamp.direction = {0, -1, 0}, lamp.range_m = 0.625f;
  box.lights.push_back(lamp);
  return box;
}

/// The same in another unit of length. Lamps need the square of it to be as bright.
scene::Scene scaled(scene::Scene scene, float factor) {
  for (scene::Mesh& mesh : scene.meshes)
    for (Vec3& p : mesh.positions) p *= factor;
  for (scene::PunctualLight& light : scene.lights) {
    light.position *= factor, light.range_m *= factor;
    light.intensity *= factor * factor;
  }
  for (scene::Camera& camera : scene.cameras)
    for (auto& row : camera.world_from_camera.row) row[3] *= factor;
  return scene;
}

std::vector<Rgb> baked_light(const scene::Scene& scene, const std::string& solver) {
  pipeline::BakeSettings settings;
  settings.solver = solver, settings.resolution = 32;
  settings.samples = 4, settings.direct_samples = 4, settings.supersample = 4;
  Progress progress;
  const auto bake = pipeline::bake_scene(scene, settings, progress);
  if (!bake) ADD_FAILURE() << solver << ": " << bake.error().message;
  return bake ? bake->light.irradiance : std::vector<Rgb>{};
}

// Light has no unit of length: E is what it was when a scene is scaled, and lamps with it. Powers
// of two round as 1 does, so not a bit may differ, up to the ends of what is held: these boxes are
// 0.5 um and 150,000 km wide. An overflow or a length that somebody held for small would show.
TEST(SlowExtremes, LightKnowsNoUnitOfLength) {
  for (const char* solver : {"gather", "hemicube", "matrix", "hierarchical", "reference"}) {
    const std::vector<Rgb> light = baked_light(box_with_lamps(), solver);
    ASSERT_GT(light.size(), 100u);
    for (const float factor : {0x1p-20f, 0x1p28f})
      EXPECT_TRUE(baked_light(scaled(box_with_lamps(), factor), solver) == light)
          << solver << ", scaled by " << factor;
  }
}

/// What is held, but hardly.
struct Extreme {
  std::string name;
  scene::Scene scene;
};
std::vector<Extreme> held_extremes() {
  std::vector<Extreme> out;
  out.push_back({"nanometres", scaled(box_with_lamps(), 1e-8f)});
  out.push_back({"one far vertex", box_with_lamps()});
  out.back().scene.meshes.back().positions[0] = {9e8f, 0.1f, 0.2f};
  out.push_back({"one far instance", box_with_lamps()});
  out.back().scene.instances.back().world_from_object = translation({0, 9e8f, 0});
  out.push_back({"lamps far away and at a corner", box_with_lamps()});
  out.back().scene.lights[0].position = {0, 1e18f, 0};
  out.back().scene.lights[1].position = out.back().scene.meshes[0].positions[0];
  return out;
}

bool has_not_a_number(const std::string& text) {
  return ::testing::Matches(::testing::ContainsRegex("[^a-z]-?nan[^a-z]"))(text);
}

// Commands end with a result, or with a sentence. Before, `probe --solver hierarchical` read beyond
// a mesh of no triangles: to a vertex 9e8 m away its faces are smaller than rounding.
TEST(SlowExtremes, EveryCommandEnds) {
  for (const Extreme& extreme : held_extremes()) {
    const ScratchFolder s;
    const auto glb = export_::scene_glb(extreme.scene);
    ASSERT_TRUE(glb);
    const std::string file = (s.path / "a.glb").string(), to = (s.path / "a").string();
    ASSERT_TRUE(write_file_atomically(file, *glb));
    for (const std::string& command :
         {"info " + file, "bake " + file + " --resolution 16 --quality draft -o " + to,
          "lux " + file + " --from " + to + " --samples 32 -o " + to + ".csv",
          "probe " + file + " --at 0.1,0.1,0.1 --time-budget 0.3",
          "probe " + file + " --at 0.1,0.1,0.1 --solver hierarchical --time-budget 2",
          "factors " + file + " --method rays --samples 64 -o " + to + ".csv",
          "factors " + file + " -o " + to + ".csv",
          "relight " + file + " --resolution 16 --patches 16 --rays 16 -o " + to + ".lxr",
          "render " + file + " --technique path --size 16x12 --samples 1 -o " + to + ".png",
          "render " + file + " --technique cads --size 16x12 -o " + to + ".png"}) {
      const CommandResult r = luxel(command);
      EXPECT_TRUE(r.code == 0 || r.code == 1 || r.code == 3)
          << extreme.name << ": " << command << " ends with " << r.code << "\n"
          << r.err;
      if (r.code != 0) EXPECT_THAT(r.err, HasSubstr("luxel: ")) << extreme.name << command;
      EXPECT_FALSE(has_not_a_number(r.out)) << extreme.name << ": " << command << "\n" << r.out;
    }
  }
}

// Places that options name.
TEST(Extremes, PlacesBeyondAreRefused) {
  const ScratchFolder s;
  const std::string box = scene_file("cornell-box.glb"), to = (s.path / "a.png").string();
  for (const std::string& command :
       {"probe " + box + " --at 1e19,0,0", "probe " + box + " --at 0,0,1e38 --solver hierarchical",
        "render " + box + " --technique cad --eye 1e19,0,0 --look-at 0,0,0 -o " + to}) {
    const CommandResult r = luxel(command);
    EXPECT_EQ(r.code, 1) << command;
    EXPECT_THAT(r.err, HasSubstr("is no place in a scene: coordinates go up to 1e+09 m"));
  }
}

}  // namespace
}  // namespace luxel::testing_support
