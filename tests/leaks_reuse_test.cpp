// A sealed room stays black when its bake goes on with what another one has left.
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/pipeline/reuse/bake_cache.h"
#include "luxel/pipeline/reuse/checkpoint.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "tests/command.h"
#include "tests/sealed_light.h"

namespace luxel::pipeline {
namespace {

namespace fs = std::filesystem;
using Edit = std::function<void(scene::Scene&)>;

/// A file of the sealed house, and a folder that its bakes leave things in.
class LeaksOfReuse : public ::testing::Test {
 protected:
  const testing_support::SealedHouse house_{0.06f, 0.3f};
  const testing_support::ScratchFolder scratch_;

  BakeSettings settings(const Edit& edit) const {
    scene::Scene scene = testing_support::sealed_house(house_);
    edit(scene);
    const auto glb = export_::scene_glb(scene);
    EXPECT_TRUE(glb && write_file_atomically(scratch_.path / "house.glb", *glb));
    BakeSettings settings = testing_support::sealed_settings(96);
    settings.scene = scratch_.path / "house.glb", settings.output = scratch_.path;
    settings.denoise = true;
    return settings;
  }
  void expect_black(const Bake& bake) const {
    const testing_support::SealedLight light = testing_support::sealed_light(house_, bake);
    ASSERT_GT(light.texels, 300u);
    EXPECT_EQ(light.lit_texels, 0u) << light.brightest;
  }
};

TEST_F(LeaksOfReuse, AResumedBakeIsBlack) {
  BakeSettings asked = settings([](scene::Scene&) {});
  asked.checkpoint_s = 1e-3;  // parts are kept from the start on
  {
    Checkpoint left(asked, settings_of_checkpoint(asked), to_json(asked));
    Progress progress;
    BakeObserver stop;
    stop.on_estimate = [&](const light::TexelScene&, const light::LightEstimate&) {
      progress.request_cancel();
    };
    const auto bake = bake_scene(asked, progress, {&left, nullptr}, stop);
    ASSERT_FALSE(bake) << "it was stopped when its first light was there";
    ASSERT_GT(left.parts()->parts_kept(), 0u);
  }
  asked.resume = true;
  Checkpoint found(asked, settings_of_checkpoint(asked), to_json(asked));
  Progress progress;
  const auto bake = bake_scene(asked, progress, {&found, nullptr});
  ASSERT_TRUE(bake) << bake.error().message;
  EXPECT_GT(found.parts()->parts_found(), 0u);
  expect_black(*bake);
}

/// Light changes by sums of layers, and by kept rays that read other light; furniture by rays that
/// are traced again beside it.
TEST_F(LeaksOfReuse, AKeptBakeStaysBlackAfterEdits) {
  const auto bake_with = [&](const Edit& edit) {
    BakeSettings asked = settings(edit);
    asked.keep = true;
    BakeCache cache(asked, settings_of_kept_bake(asked));
    Progress progress;
    const auto bake = bake_scene(asked, progress, {nullptr, &cache});
    EXPECT_TRUE(bake) << bake.error().message;
    if (!bake) return false;
    cache.finish(progress);
    expect_black(*bake);
    return cache.found() != nullptr && bake->light.rays_kept > 0;
  };
  EXPECT_FALSE(bake_with([](scene::Scene&) {}));
  const std::pair<const char*, Edit> edits[] = {
      {"a brighter sun", [](scene::Scene& s) { s.lights[0].intensity *= 2; }},
      {"a later sun",
       [](scene::Scene& s) {
         s.lights[0].direction = normalize(Vec3{0.6f, -0.5f, 0.3f});
       }},
      {"another lawn",
       [](scene::Scene& s) {
         s.materials[0].base_color = {0.8f, 0.3f, 0.3f};
       }},
      {"a shell that is moved", [](scene::Scene& s) {
         for (scene::Instance& i : s.instances)
           if (s.meshes[i.mesh].name == "shell") i.world_from_object.row[2][3] += 0.05f;
       }}};
  for (const auto& [what, edit] : edits) {
    SCOPED_TRACE(what);
    EXPECT_TRUE(bake_with(edit)) << "it builds on the first one";
  }
}

}  // namespace
}  // namespace luxel::pipeline
