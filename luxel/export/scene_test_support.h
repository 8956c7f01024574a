// A scene with one of everything, for the tests of export.
#pragma once

#include "luxel/atlas/atlas.h"
#include "luxel/base/random.h"
#include "luxel/export/glb_test_support.h"
#include "luxel/image/codec.h"
#include "luxel/scene/scene.h"

namespace luxel::export_ {

inline scene::Mesh grid_mesh() {
  scene::Mesh mesh;
  mesh.name = "grid";
  RandomStream random{21};
  for (int y = 0; y <= 6; ++y)
    for (int x = 0; x <= 6; ++x) {
      mesh.positions.push_back({float(x), random.next(), float(y)});
      mesh.normals.push_back(normalize(Vec3{random.next() - 0.5f, 1, random.next() - 0.5f}));
      mesh.uv0.push_back({random.next(), random.next()});
      mesh.colors.push_back({random.next(), random.next(), random.next()});
    }
  for (uint32_t y = 0; y < 6; ++y)
    for (uint32_t x = 0; x < 6; ++x) {
      const uint32_t a = 7 * y + x;
      mesh.triangles.push_back({a, a + 7, a + 1});
      mesh.triangles.push_back({a + 1, a + 7, a + 8});
      mesh.triangle_material.push_back((x + y) % 3);  // materials change all the time
      mesh.triangle_material.push_back((x + y) % 3);
    }
  return mesh;
}

inline void add_materials(scene::Scene& scene) {
  scene::Texture texture;
  texture.name = "checker";
  texture.width = 2, texture.height = 2;
  texture.rgba = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 9, 9, 9, 0};
  scene.textures.push_back(texture);
  scene.textures.push_back(texture);
  scene.textures[1].encoded = image::encode_png({2, 2, 4, texture.rgba});
  scene.materials.resize(4);
  scene.materials[0].name = "painted";
  scene.materials[0].base_color = {0.1f, 0.2f, 0.3f};
  scene.materials[0].base_color_texture.texture = 0;
  scene.materials[0].base_color_texture.offset = {0.5f, 0};
  scene.materials[0].base_color_texture.rotation = 1;
  scene.materials[0].base_color_texture.wrap_u = scene::Wrap::mirror;
  scene.materials[1].name = "lamp";
  scene.materials[1].emission = {17.3f, 0.1f, 100};
  scene.materials[1].double_sided = true;
  scene.materials[2].name = "leaf";
  scene.materials[2].alpha_mode = scene::AlphaMode::mask;
  scene.materials[2].alpha_cutoff = 0.25f;
  scene.materials[2].metallic_texture.texture = 1;
  scene.materials[2].metallic_texture.filter = scene::Filter::nearest;
  scene.materials[3].name = "sign";
  scene.materials[3].unlit = true;
  scene.materials[3].alpha_mode = scene::AlphaMode::blend;
  scene.materials[3].base_color_texture.texture = 1;  // but its mesh has no coordinates
}

inline scene::Scene rich_scene() {
  scene::Scene scene;
  scene.name = "rich";
  add_materials(scene);
  scene.meshes.push_back(grid_mesh());
  scene::Mesh plain;
  plain.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}};
  plain.triangles = {{0, 1, 2}};
  plain.triangle_material = {3};
  scene.meshes.push_back(plain);
  Mat34 shear = translation({1, 2, 3});
  shear.row[0][1] = 0.7f;
  Mat34 turned = rotation({0.5, 0.5, 0.5, 0.5}) * scaling({100, 200, 300});
  scene.instances = {{"here", 0, {}},
                     {"mirrored", 0, scaling({-2, 1, 1})},
                     {"sheared", 0, shear},
                     {"sheared mirror", 0, shear * scaling({1, 1, -3})},
                     {"flat", 1, scaling({1, 0, 1})},
                     {"large", 0, turned},
                     {"plain", 1, translation({5, 0, 0})}};
  using Kind = scene::PunctualLight::Kind;
  scene.lights.resize(3);
  scene.lights[0].name = "bulb", scene.lights[0].position = {1, 2, 3};
  scene.lights[0].range_m = 7;
  scene.lights[1].kind = Kind::spot, scene.lights[1].intensity = {4, 8, 2};
  scene.lights[1].direction = normalize(Vec3{1, -2, 0.5f});
  scene.lights[1].position = {-1, 4, 0};
  scene.lights[2].kind = Kind::directional, scene.lights[2].angular_radius_rad = 0.00465f;
  scene.cameras.resize(2);
  scene.cameras[0].name = "front", scene.cameras[0].aspect = 1.5f;
  scene.cameras[0].world_from_camera = translation({0, 1, 9});
  scene.cameras[1].orthographic_height_m = 4;
  scene.background = {0.5f, 0.25f, 1};
  return scene;
}

/// Every second column of the grid is a chart of its own; other triangles lie alone.
inline atlas::Atlas made_up_atlas(const scene::Scene& scene) {
  atlas::Atlas atlas;
  atlas.resolution = 1024;
  atlas.first_triangle = first_triangles(scene);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const float chart = float(t / 2 % 6 / 2);  // columns 01, 23, 45
      std::array<Vec2, 3> corners;
      for (size_t c = 0; c < 3; ++c) {
        const Vec3 p = mesh.positions[mesh.triangles[t][c]];
        corners[c] = {100 * float(i) + p.x * 8 + 10 * chart, p.z * 8 + p.y};
      }
      atlas.corners.push_back(corners);
      atlas.chart.push_back(uint32_t(chart));
    }
  }
  return atlas;
}

inline image::Image ramp_lightmap() {
  image::Image lightmap(64, 64, 4);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 60; ++x) {
      const float e = 0.01f * float(64 * y + x);
      lightmap.set_rgb(x, y, {e, 2 * e, 0.5f * e});
      lightmap.at(x, y)[3] = 1;
    }
  return lightmap;
}

}  // namespace luxel::export_
