#include "luxel/pipeline/texels/texel_layout.h"

#include <gtest/gtest.h>

#include <array>

#include "luxel/scene/shapes.h"
#include "luxel/transport/visible_samples.h"

namespace luxel::pipeline {
namespace {

constexpr uint32_t kSmall = 2;

/// A floor, a large box on it that stays, and a small one; texels across their feet.
scene::Scene layout_room() {
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

/// A layout that is kept, of a room in which nothing has moved yet.
struct Kept {
  BakeSettings settings;
  Progress progress;
  scene::Scene scene = layout_room();
  KeptLayout layout;

  Kept() {
    settings.resolution = 128;
    const auto laid_out = lay_out_texels(settings, scene, progress);
    EXPECT_TRUE(laid_out);
    if (laid_out) layout = keep_layout(scene, *laid_out);
  }
};

// The layout of then, with the samples that opening all anew would give.
TEST(LayOutAgain, OpensTheSamplesThatOpeningAllWould) {
  Kept kept;
  scene::Scene now = layout_room();
  ASSERT_FALSE(kept.layout.repair.moved.empty());
  now.instances[kSmall].world_from_object.row[0][3] += 0.4f;
  const std::array boxes{bounds_of(kept.scene, kSmall), bounds_of(now, kSmall)};
  const auto again = lay_out_again(kept.settings, kept.layout, boxes, now, kept.progress);
  ASSERT_TRUE(again);
  atlas::TexelMap map = atlas::rasterise(now, again->atlas);
  const auto all =
      *transport::move_samples_out_of_solids(now, again->atlas, again->tracer, map, kept.progress);
  EXPECT_NE(all.moved, kept.layout.repair.moved);
  EXPECT_EQ(again->repair.moved, all.moved);
  EXPECT_EQ(again->near_back_faces, all.near_back_faces);
  ASSERT_EQ(again->map.texels.size(), map.texels.size());
  for (size_t i = 0; i < map.texels.size(); ++i) {
    EXPECT_EQ(again->map.texels[i].sample.at.u, map.texels[i].sample.at.u);
    EXPECT_EQ(again->map.texels[i].sample.at.v, map.texels[i].sample.at.v);
  }
}

TEST(LayOutAgain, LeavesSamplesWhereNothingMoved) {
  Kept kept;
  scene::Scene now = layout_room();
  const auto again = lay_out_again(kept.settings, kept.layout, {}, now, kept.progress);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->repair.moved, kept.layout.repair.moved);
  EXPECT_EQ(again->near_back_faces, kept.layout.near_back_faces);
  ASSERT_EQ(again->map.texels.size(), kept.layout.texels.size());
  for (size_t i = 0; i < kept.layout.texels.size(); ++i)
    EXPECT_EQ(again->map.texels[i].sample.at.u, kept.layout.texels[i].sample.at.u);
}

}  // namespace
}  // namespace luxel::pipeline
