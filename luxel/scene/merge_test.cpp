// Several models in one scene: nothing is lost, and everything refers to its own.
#include "luxel/scene/merge.h"

#include <gtest/gtest.h>

#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/scene/validate.h"

namespace luxel::scene {
namespace {

/// A quad at a height, of a colour and a texture of its own.
Scene quad_at(float y, Rgb color, uint8_t pixel) {
  Scene out;
  add_material(out, "paint", color);
  out.textures.push_back({"t", 1, 1, {pixel, pixel, pixel, 255}, {}, {}});
  out.materials[0].base_color_texture.texture = 0;
  Mesh mesh;
  add_quad(mesh, {Vec3{0, y, 0}, {0, y, 1}, {1, y, 1}, {1, y, 0}}, 0);
  mesh.uv0.assign(mesh.positions.size(), {});
  place(out, std::move(mesh), {});
  out.lights.push_back({});
  out.lights[0].position.y = y, out.lights[0].profile = 0;
  out.profiles.push_back({});
  out.cameras.push_back({});
  return out;
}

TEST(Merge, EachModelKeepsItsPlaceItsColourAndItsPictures) {
  const std::vector<Scene> models{quad_at(1, {0.25f, 0.5f, 1}, 255), quad_at(2, {1, 0.5f, 0}, 0),
                                  quad_at(3, {0.5f, 0.5f, 0.5f}, 255)};
  const Scene out = merged(models);
  ASSERT_EQ(out.instances.size(), 3u);
  ASSERT_EQ(out.lights.size(), 3u);
  EXPECT_EQ(out.cameras.size(), 3u);
  for (uint32_t i = 0; i < 3; ++i) {
    const SurfacePoint middle{i, 0, {0.5f, 0.25f}}, own{0, 0, {0.5f, 0.25f}};
    EXPECT_EQ(world_position(out, middle).y, float(i + 1));
    EXPECT_EQ(base_color_at(out, middle), base_color_at(models[i], own));
    EXPECT_EQ(out.lights[i].position.y, float(i + 1));
    EXPECT_EQ(out.lights[i].profile, i);
  }
  EXPECT_EQ(base_color_at(out, {1, 0, {}})[0], 0) << "its own black texture";
}

TEST(Merge, OneModelIsItselfAndTheFirstSurroundingsStay) {
  Scene dark = quad_at(1, {1, 1, 1}, 255), blue = quad_at(2, {1, 1, 1}, 255), red = blue;
  blue.background = {0, 0, 1}, red.background = {1, 0, 0};
  EXPECT_EQ(merged(std::vector{dark, blue, red}).background.z, 1);
  EXPECT_EQ(merged(std::vector{dark, blue, red}).background.x, 0);
  const Scene alone = merged(std::vector{cornell_box()});
  EXPECT_EQ(alone.meshes.size(), cornell_box().meshes.size());
  EXPECT_EQ(first_triangles(alone), first_triangles(cornell_box()));
  EXPECT_TRUE(merged({}).meshes.empty());
}

}  // namespace
}  // namespace luxel::scene
