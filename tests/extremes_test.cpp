// Scenes at the ends of what single precision holds (luxel/scene/held_range.h), and beyond them.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/pipeline/settings/outside_light.h"
#include "tests/command.h"
#include "tests/extremes.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

/// A scene that is held, but hardly.
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
          "probe " + file + " --at 0.1,0.1,0.1 --solver hierarchical --time-budget 0.5",
          "factors " + file + " --method rays --samples 64 -o " + to + ".csv",
          "relight " + file + " --resolution 16 --patches 16 --rays 16 -o " + to + ".lxr",
          "render " + file + " --technique path --size 16x12 --samples 1 -o " + to + ".png",
          "render " + file + " --technique cads --size 16x12 -o " + to + ".png"}) {
      const CommandResult r = luxel(command);
      EXPECT_TRUE(r.code == 0 || r.code == 1 || r.code == 3)
          << extreme.name << ": " << command << " ends with " << r.code << "\n"
          << r.err;
      if (r.code != 0) {
        EXPECT_THAT(r.err, HasSubstr("luxel: ")) << extreme.name << command;
      }
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
    EXPECT_THAT(r.err, HasSubstr("is too far away: coordinates go up to 1e+09 m"));
  }
}

// Sums that overflow, where no lamp is too bright by itself: at the far corners each makes 7e14
// lux, and on the floor under them 100 make more than what is held. `bake` aborted while stitching.
TEST(SlowExtremes, LightThatOverflowsIsASentence) {
  scene::Scene box = scene::cornell_box(scene::CornellColors::pbrt, false);
  scene::PunctualLight lamp{"lamp", scene::PunctualLight::Kind::point, {3e14f, 3e14f, 3e14f}};
  lamp.position = {0.27f, 0.02f, 0.28f};
  box.lights.assign(100, lamp);
  const ScratchFolder s;
  const auto glb = export_::scene_glb(box);
  ASSERT_TRUE(glb);
  const std::string file = (s.path / "a.glb").string(), to = (s.path / "a").string();
  ASSERT_TRUE(write_file_atomically(file, *glb));
  const std::string bake = "bake " + file + " --resolution 32 -o " + to + " --solver ";
  for (const std::string& command :
       {bake + "gather --quality draft", bake + "hemicube --max-elements 2000",
        bake + "matrix --patches 64", bake + "hierarchical", bake + "reference --samples 1",
        "probe " + file + " --at 0.27,0,0.28 --time-budget 0.3",
        "render " + file + " --technique path --view top --size 64x48 --samples 4 -o " + to +
            ".exr"}) {
    const CommandResult r = luxel(command);
    EXPECT_EQ(r.code, 1) << command << "\n" << r.err;
    EXPECT_THAT(r.err, ::testing::AllOf(HasSubstr("is above 1e+18, too bright to store"),
                                        HasSubstr("light 0 (lamp), whose intensity of 3e+14")))
        << command;
    EXPECT_EQ(files_in(s.path), std::set<std::string>{"a.glb"}) << command;
  }
}

// Options and files whose light is too bright by itself: said before the work.
TEST(Extremes, TooBrightLightIsASentence) {
  const ScratchFolder s;
  const std::string box = scene_file("cornell-box.glb"), to = (s.path / "a").string();
  for (const auto& [options, sentence] :
       {std::pair{"--sun 0,45,1e37", "--sun '0,45,1e37' is too bright; it may be 1e+15 lux"},
        std::pair{"--sun 0,45,1e300", "--sun '0,45,1e300' is too bright"},
        std::pair{"--background 1,1e38,1", "--background '1,1e38,1' is too bright"},
        std::pair{"--background 1,1,1e300", "--background '1,1,1e300' is too bright"},
        std::pair{"--environment sky.hdr,0,1e38", "the scale may be 1e+15 at most"}})
    for (const std::string& command :
         {"bake " + box + " -o " + to + " ", "relight " + box + " -o " + to + ".lxr ",
          "probe " + box + " --at 0,0,0 ", "render " + box + " -o " + to + ".png "}) {
      const CommandResult r = luxel(command + options);
      EXPECT_EQ(r.code, 1) << command << options;
      EXPECT_THAT(r.err, HasSubstr(sentence)) << command << options;
    }
  EXPECT_TRUE(files_in(s.path).empty());
  EXPECT_TRUE(pipeline::parse_sun("0,45,1e15")) << "the most that is said";
}

}  // namespace
}  // namespace luxel::testing_support
