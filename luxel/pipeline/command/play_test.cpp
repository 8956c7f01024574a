// Scenes far from their origin, played: the same bits as near it.
#include "luxel/pipeline/command/play.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/pipeline/command/relight.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/matrix/lxr.h"
#include "tests/scratch_folder.h"

namespace luxel::pipeline {
namespace {

/// Single precision has steps of 1 / 64 m there.
constexpr DVec3 kFarAway{65536, 0, -131072};

/// To a place that it holds there, and from there to another origin.
Mat34 put_at(Vec3 by, Mat34 m) {
  for (auto& row : m.row) row[3] = std::round(64 * row[3]) / 64;
  return translation(by) * m;
}

class FarPlay : public ::testing::Test {
 protected:
  /// The Cornell box with this place as its origin, prepared.
  matrix::RelightData prepare(const std::string& name, DVec3 origin) {
    scene::Scene scene = scene::cornell_box();
    for (scene::Instance& instance : scene.instances)
      instance.world_from_object = put_at(to_float(origin), instance.world_from_object);
    for (scene::Camera& camera : scene.cameras)
      camera.world_from_camera = put_at(to_float(origin), camera.world_from_camera);
    RelightSettings s;
    s.scene = folder_.path / "box.glb", s.output = folder_.path / (name + ".lxr");
    s.resolution = 32, s.matrix.patches.count = 100, s.matrix.factors.rays_per_patch = 64;
    s.reading.origin = origin;
    EXPECT_TRUE(write_file_atomically(s.scene, *export_::scene_glb(scene)));
    Progress progress;
    const auto report = relight(s, progress);
    EXPECT_TRUE(report) << report.error().message;
    auto data = matrix::read_lxr(s.output);
    EXPECT_TRUE(data) << data.error().message;
    return std::move(*data);
  }
  /// The only frame of a script, whose eye and lamp are given relative to a place.
  std::vector<std::byte> frame_of(const std::string& name, DVec3 o) {
    const std::string script = fmt::format(
        R"({{"frames": 1, "size": [24, 18], "exposure": 0,
            "camera": {{"eye": [{:.4f}, 0.25, {:.4f}], "look_at": [{:.4f}, 0.25, {:.4f}]}},
            "lights": [{{"position": [{:.4f}, 0.375, {:.4f}], "intensity": [0.5, 0.25, 0.125]}}]}})",
        o.x + 0.25, o.z - 0.75, o.x + 0.25, o.z + 0.25, o.x + 0.125, o.z + 0.0625);
    PlaySettings s;
    s.lxr = folder_.path / (name + ".lxr"), s.output = folder_.path / name;
    s.script = folder_.write(name + ".json", script);
    Progress progress;
    const auto played = play(s, progress);
    EXPECT_TRUE(played) << played.error().message;
    auto picture = read_file(s.output / "frame-0000.png");
    EXPECT_TRUE(picture);
    return std::move(*picture);
  }

  testing_support::ScratchFolder folder_;
};

TEST_F(FarPlay, HasTheBitsOfTheNearScene) {
  const matrix::RelightData near = prepare("near", {});
  matrix::RelightData far = prepare("far", kFarAway);
  EXPECT_EQ(near.origin, DVec3{});
  EXPECT_EQ(far.origin, kFarAway);
  far.origin = {};
  EXPECT_EQ(matrix::encode_lxr(far), matrix::encode_lxr(near)) << "all else is relative to it";
  const std::vector<std::byte> picture = frame_of("near", {});
  EXPECT_EQ(frame_of("far", kFarAway), picture) << "places of a script are those of the file";
}

}  // namespace
}  // namespace luxel::pipeline
