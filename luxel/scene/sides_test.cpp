#include "luxel/scene/sides.h"

#include <gtest/gtest.h>

#include "luxel/scene/shapes.h"

namespace luxel::scene {
namespace {

Mesh sheet() {
  Mesh mesh;
  add_quad(mesh, {Vec3{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}, 0);
  return mesh;
}

Scene scene_of(Mesh mesh, bool double_sided = true) {
  Scene scene;
  add_material(scene, "sheet", {0.5f, 0.5f, 0.5f});
  scene.materials[0].double_sided = double_sided;
  place(scene, std::move(mesh));
  return scene;
}

void expect_other_sides(const Scene& scene, size_t pairs) {
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.other_side.size(), mesh.triangles.size());
  size_t linked = 0;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const SurfacePoint p{0, t, {0.2f, 0.3f}};
    const auto other = other_side_of(scene, p);
    if (!other) continue;
    ++linked;
    EXPECT_EQ(other_side_of(scene, *other)->triangle, t);
    EXPECT_LT(length(world_position(scene, *other) - world_position(scene, p)), 1e-6f);
    EXPECT_LT(length(shading_normal(scene, *other) + shading_normal(scene, p)), 1e-6f);
    EXPECT_FALSE(material_at(scene, p).double_sided);
  }
  EXPECT_EQ(linked, 2 * pairs);
}

TEST(Sides, ABackIsTheSamePlaceSeenFromBehind) {
  for (const bool with_normals : {false, true}) {
    Mesh mesh = sheet();
    for (const Vec3& p : mesh.positions)
      if (with_normals) mesh.normals.push_back(normalize(Vec3{p.x - 1, p.y, 2}));
    for (const Vec3& p : mesh.positions) {
      mesh.uv0.push_back({p.x, p.y});
      mesh.uv1.push_back({p.y, 1 - p.x});
      mesh.colors.push_back({p.x, p.y, 1});
      mesh.alphas.push_back(0.3f * p.x + 0.2f * p.y);
    }
    Scene scene = scene_of(std::move(mesh));
    add_backs(scene, 0, std::vector<uint8_t>{1, 0});
    ASSERT_EQ(scene.meshes[0].triangles.size(), 3u);
    expect_other_sides(scene, 1);
    const SurfacePoint p{0, 0, {0.2f, 0.3f}};
    const SurfacePoint behind = *other_side_of(scene, p);
    // The texture goes through: both look it up at the same place, and have the same colours.
    const Mesh& m = scene.meshes[0];
    const auto at = [&](const auto& values, const SurfacePoint& q) {
      const auto& t = m.triangles[q.triangle];
      return interpolate(values[t[0]], values[t[1]], values[t[2]], q.at);
    };
    EXPECT_LT(length(at(m.uv0, p) - at(m.uv0, behind)), 1e-6f);
    EXPECT_LT(length(at(m.uv1, p) - at(m.uv1, behind)), 1e-6f);
    EXPECT_LT(length(at(m.colors, p) - at(m.colors, behind)), 1e-6f);
    EXPECT_NEAR(base_color_at(scene, p)[3], base_color_at(scene, behind)[3], 1e-6f);
    EXPECT_LT(base_color_at(scene, p)[3], 0.6f);
    if (with_normals) {
      EXPECT_LT(length(at(m.normals, p) + at(m.normals, behind)), 1e-6f);
    }
    EXPECT_TRUE(material_at(scene, {0, 1, {}}).double_sided);
    EXPECT_FALSE(other_side_of(scene, {0, 1, {}}));
  }
}

TEST(Sides, ASheetThatAFileHoldsTwiceIsFound) {
  Mesh mesh = sheet();
  // The other side with vertices of its own, cut by the same diagonal, corners in another order.
  Mesh back = sheet();
  const uint32_t n = uint32_t(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), back.positions.begin(), back.positions.end());
  for (const auto& [a, b, c] : back.triangles) {
    mesh.triangles.push_back({n + b, n + a, n + c});
    mesh.triangle_material.push_back(0);
  }
  Scene scene = scene_of(std::move(mesh));
  EXPECT_EQ(link_sides(scene), 2u);
  expect_other_sides(scene, 2);
  EXPECT_EQ(link_sides(scene), 0u);  // once
}

TEST(Sides, WhatIsNotTheOtherSideIsLeftAlone) {
  Mesh twice = sheet();  // the same side two times
  twice.triangles.push_back(std::array<uint32_t, 3>(twice.triangles[0]));
  twice.triangle_material.push_back(0);
  Scene scene = scene_of(std::move(twice));
  EXPECT_EQ(link_sides(scene), 0u);
  EXPECT_TRUE(scene.meshes[0].other_side.empty());
  EXPECT_EQ(scene.materials.size(), 1u);
  const auto [u, v, w] = scene.meshes[0].triangles[0];
  scene.meshes[0].triangles[1] = {v, u, w};  // front, back and front again: one has no partner
  scene.meshes[0].triangles[2] = {u, v, w};
  EXPECT_EQ(link_sides(scene), 1u);
  EXPECT_EQ(scene.meshes[0].other_side, (std::vector<uint32_t>{1, 0, kNone}));
  // A leaf whose sides show different parts of a texture with holes.
  Mesh leaf = sheet();
  const auto [a, b, c] = leaf.triangles[0];
  leaf.triangles = {{a, b, c}, {a + 4, c + 4, b + 4}};
  leaf.triangle_material = {0, 0};
  const std::vector<Vec3> positions = leaf.positions;
  leaf.positions.insert(leaf.positions.end(), positions.begin(), positions.end());
  for (const Vec3& p : leaf.positions) leaf.uv0.push_back({p.x, p.y});
  for (size_t k = 4; k < 8; ++k) leaf.uv0[k].x += 0.5f;
  Scene holes = scene_of(std::move(leaf));
  holes.materials[0].alpha_mode = AlphaMode::mask;
  holes.materials[0].base_color_texture.texture = 0;
  EXPECT_EQ(link_sides(holes), 0u);
  std::swap(holes.meshes[0].uv0, holes.meshes[0].uv1);
  holes.materials[0].base_color_texture.uv_set = 1;
  EXPECT_EQ(link_sides(holes), 0u);
  // As in a baked file: the picture is the same, and each side has its own place in the lightmap.
  holes.materials[0].base_color_texture.uv_set = 0;
  Scene baked = holes;
  EXPECT_EQ(link_sides(baked), 1u);
  holes.meshes[0].uv1.clear();
  add_material(holes, "other holes", {0.5f, 0.5f, 0.5f});
  holes.meshes[0].triangle_material[1] = 1;
  EXPECT_EQ(link_sides(holes), 0u);
  holes.materials[0].alpha_mode = AlphaMode::opaque;
  EXPECT_EQ(link_sides(holes), 1u);
  // Corners say where holes are, too.
  baked.meshes[0].other_side.clear();
  baked.meshes[0].alphas = {0, 1, 1, 1, 0, 1, 1, 1};
  Scene alike = baked;
  EXPECT_EQ(link_sides(alike), 1u);
  baked.meshes[0].alphas[4] = 1;
  EXPECT_EQ(link_sides(baked), 0u);
}

}  // namespace
}  // namespace luxel::scene
