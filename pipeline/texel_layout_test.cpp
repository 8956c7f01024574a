#include "pipeline/texel_layout.h"

#include <gtest/gtest.h>

#include <array>

#include "scene/shapes.h"
#include "transport/open_samples.h"

namespace luxel::pipeline {
namespace {

constexpr uint32_t kSmall = 2;

/// A floor, a large box on it that stays, and a small one; texels across their feet.
scene::Scene room() {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {0, 4, 0, 4}, 0, true, 0);
  for (const Box3& box : {Box3{{2.03f, 0, 1.03f}, {3.51f, 1, 3.01f}},
                          Box3{{0.51f, 0, 0.53f}, {0.97f, 0.5f, 0.99f}}}) {
    scene::Mesh mesh;
    scene::add_box(mesh, box.lower, box.upper, 0);
    scene::place(scene, std::move(mesh));
  }
  return scene;
}

Box3 bounds_of(const scene::Scene& scene, uint32_t instance) {
  Box3 out;
  const scene::Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
  for (const Vec3& p : mesh.positions)
    out.extend(transform_point(scene.instances[instance].world_from_object, p));
  return out;
}

// The layout of then, with the samples that opening all anew would give.
TEST(LayOutAgain, OpensTheSamplesThatOpeningAllWould) {
  BakeSettings settings;
  settings.resolution = 128;
  Progress progress;
  scene::Scene then = room(), now = room();
  const auto layout = lay_out_texels(settings, then, progress);
  ASSERT_TRUE(layout);
  const KeptLayout kept = keep_layout(then, *layout);
  const std::vector<uint32_t> moved_then = kept.repair.moved;
  ASSERT_FALSE(moved_then.empty());
  now.instances[kSmall].world_from_object.row[0][3] += 0.4f;
  const std::array boxes{bounds_of(then, kSmall), bounds_of(now, kSmall)};
  const auto again = lay_out_again(settings, kept, boxes, now, progress);
  ASSERT_TRUE(again);
  atlas::TexelMap map = atlas::rasterise(now, again->atlas);
  const auto all = transport::open_samples(now, again->atlas, again->tracer, map);
  EXPECT_NE(all.moved, moved_then);
  EXPECT_EQ(again->repair.moved, all.moved);
  EXPECT_EQ(again->near_backs, all.near_backs);
  ASSERT_EQ(again->map.texels.size(), map.texels.size());
  for (size_t i = 0; i < map.texels.size(); ++i) {
    EXPECT_EQ(again->map.texels[i].sample.at.u, map.texels[i].sample.at.u);
    EXPECT_EQ(again->map.texels[i].sample.at.v, map.texels[i].sample.at.v);
  }
}

TEST(LayOutAgain, LeavesSamplesWhereNothingMoved) {
  BakeSettings settings;
  settings.resolution = 128;
  Progress progress;
  scene::Scene then = room(), now = room();
  const auto layout = lay_out_texels(settings, then, progress);
  ASSERT_TRUE(layout);
  const auto again = lay_out_again(settings, keep_layout(then, *layout), {}, now, progress);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->repair.moved, layout->repair.moved);
  EXPECT_EQ(again->near_backs, layout->near_backs);
  for (size_t i = 0; i < layout->map.texels.size(); ++i)
    EXPECT_EQ(again->map.texels[i].sample.at.u, layout->map.texels[i].sample.at.u);
}

}  // namespace
}  // namespace luxel::pipeline
