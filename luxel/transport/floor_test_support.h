// A floor with things on it, laid out texel by texel, for tests of what lies inside of solids.
#pragma once

#include "luxel/atlas/atlas.h"
#include "luxel/scene/scene.h"
#include "luxel/scene/shapes.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/barriers.h"
#include "luxel/transport/visible_samples.h"

namespace luxel::transport {

/// A floor of 2 x 2 m as one chart of 32 x 32 texels (16 per metre), and what stands on it.
struct Floor {
  static constexpr int kSide = 32;
  scene::Scene scene;
  atlas::Atlas atlas;
  atlas::TexelMap map;

  Floor() {
    scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
    scene::add_rectangle(scene, {0, 2, 0, 2}, 0, true, 0);
  }
  void add_box(Vec3 low, Vec3 high, uint32_t material = 0) {
    scene::Mesh box;
    scene::add_box(box, low, high, material);
    scene::place(scene, std::move(box));
  }
  /// Rasterised when all stands; only the floor has a place in the atlas.
  trace::RayTracer tracer() {
    atlas.resolution = kSide;
    atlas.first_triangle = scene::first_triangles(scene);
    atlas.corners.assign(atlas.first_triangle.back(), {Vec2{0, 0}, Vec2{0, 0}, Vec2{0, 0}});
    atlas.chart.assign(atlas.first_triangle.back(), 1);
    atlas.chart_count = 2;
    const scene::Mesh& floor = scene.meshes[0];
    for (uint32_t t = 0; t < 2; ++t) {
      atlas.chart[t] = 0;
      for (size_t k = 0; k < 3; ++k) {
        const Vec3 p = floor.positions[floor.triangles[t][k]];
        atlas.corners[t][k] = {p.x * kSide / 2, p.z * kSide / 2};
      }
    }
    map = atlas::rasterise(scene, atlas);
    std::erase_if(map.texels, [](const atlas::Texel& t) { return t.triangle_number > 1; });
    std::fill(map.texel_at.begin(), map.texel_at.end(), atlas::kNone);
    for (uint32_t i = 0; i < map.texels.size(); ++i)
      map.texel_at[map.texels[i].y * kSide + map.texels[i].x] = i;
    return *trace::RayTracer::build(scene);
  }
  /// A box without a bottom.
  void add_shell(Vec3 low, Vec3 high) {
    scene::Mesh box;
    scene::add_box(box, low, high, 0);
    std::erase_if(box.triangles, [&](const std::array<uint32_t, 3>& t) {
      return std::ranges::all_of(t, [&](uint32_t v) { return box.positions[v].y == low.y; });
    });
    box.triangle_material.resize(box.triangles.size());
    scene::place(scene, std::move(box));
  }
  std::vector<atlas::PartedPoints> parted() {
    const trace::RayTracer rays = tracer();
    Progress progress;
    return *find_parted(scene, atlas, map, rays, progress);
  }
  /// move_samples_out_of_solids() with the tracer that tracer() gave.
  MovedSamples move_samples(const trace::RayTracer& rays) {
    Progress progress;
    return *move_samples_out_of_solids(scene, atlas, rays, map, progress);
  }
  /// move_samples_near_changes(), too.
  MovedSamples move_samples_near(std::span<const Box3> boxes,
                                 std::span<const uint32_t> near_back_faces,
                                 const trace::RayTracer& rays) {
    Progress progress;
    return *move_samples_near_changes(scene, atlas, rays, boxes, near_back_faces, map, progress);
  }
};

inline const Vec3 kLamp{0.33f, 0.1f, 1};

/// A shell over the floor that stands on nothing, with a lamp that shines in under its edge.
inline Floor floor_under_a_shell() {
  Floor floor;
  floor.add_shell({0.53f, 0.15f, 0.53f}, {1.47f, 0.6f, 1.47f});
  scene::PunctualLight lamp;
  lamp.position = kLamp;
  floor.scene.lights.push_back(lamp);
  return floor;
}

}  // namespace luxel::transport
