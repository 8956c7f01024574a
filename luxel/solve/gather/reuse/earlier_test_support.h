// A room before and after an edit, and gather that builds on what an earlier bake kept of it.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "luxel/scene/shapes.h"
#include "luxel/solve/gather/gather_test_support.h"
#include "luxel/solve/gather/reuse/earlier.h"

namespace luxel::gather {

namespace fs = std::filesystem;
using Edit = std::function<void(scene::Scene&)>;

/// Instances and materials of open_room() by number.
constexpr uint32_t kFloor = 0, kWall = 1, kBox = 2, kPane = 3;
constexpr uint32_t kPaint = 1, kGlass = 2;

/// A floor and a wall under an even sky with a lamp above, a box on the floor, and a thin pane,
/// whose two sides are near to each other: rays end nearer than a texel is wide in the joints.
inline scene::Scene open_room() {
  scene::Scene scene;
  scene.background = {0.4f, 0.5f, 0.7f};
  const uint32_t gray = scene::add_material(scene, "gray", {0.6f, 0.6f, 0.6f}, {});
  scene::add_material(scene, "paint", {0.7f, 0.3f, 0.2f}, {});
  scene::add_material(scene, "glass", {0.9f, 0.4f, 0.3f}, {});
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, gray);
  scene::Mesh wall, box, pane;
  scene::add_quad(wall, {Vec3{-2, 0, -2}, {2, 0, -2}, {2, 2, -2}, {-2, 2, -2}}, gray);
  scene::add_box(box, {-0.3f, 0.01f, -0.3f}, {0.3f, 0.5f, 0.3f}, kPaint);
  scene::add_box(pane, {-0.8f, 0.2f, 0.8f}, {0.8f, 0.9f, 0.82f}, kGlass);
  scene::place(scene, std::move(wall));
  scene::place(scene, std::move(box));
  scene::place(scene, std::move(pane));
  scene.lights.resize(1);
  scene.lights[0].position = {1.2f, 2.5f, 0.7f}, scene.lights[0].intensity = {3, 2, 1};
  return scene;
}

inline void make_glass(scene::Scene& scene) {
  scene.materials[kGlass].alpha_mode = scene::AlphaMode::blend;
  scene.materials[kGlass].alpha = 0.5f, scene.materials[kGlass].double_sided = true;
}

inline void move_box(scene::Scene& scene) {
  scene.instances[kBox].world_from_object = translation({0.7f, 0, -0.4f});
}

/// The edited scene on the same map.
inline std::unique_ptr<Room> edited(const Room& room, const Edit& edit) {
  auto out = std::make_unique<Room>();
  out->scene = room.scene;
  edit(out->scene);
  out->atlas = room.atlas;
  out->map = atlas::rasterise(out->scene, out->atlas);
  make_ready(*out);
  return out;
}

/// Grown by the rounding of positions some metres away from 0, and more.
inline Box3 bounds_of(const scene::Scene& scene, uint32_t instance) {
  Box3 out;
  const uint32_t mesh = scene.instances[instance].mesh;
  for (uint32_t t = 0; t < scene.meshes[mesh].triangles.size(); ++t) {
    const scene::Triangle3 corners = scene::world_triangle(scene, instance, t);
    for (const Vec3& v : {corners.a, corners.b, corners.c}) out.extend(v);
  }
  constexpr Vec3 kMargin{1e-4f, 1e-4f, 1e-4f};
  return {out.lower - kMargin, out.upper + kMargin};
}

inline GatherParams some_params() { return with_samples(32, 8); }

inline uint32_t places_of(const Room& room) {
  const uint32_t side = uint32_t(room.atlas.resolution);
  return (side + 2) * (side + 2);
}
inline size_t tile_count(size_t elements) { return (elements + kTileElements - 1) / kTileElements; }
inline size_t tile_size(size_t elements, size_t tile) {
  return std::min(kTileElements, elements - tile * kTileElements);
}

class EarlierGather : public WithFolder {
 public:
  /// Solves, and keeps the rays under a name.
  Gather keeping(const Room& room, const GatherParams& params, const std::string& name,
                 Earlier* earlier = nullptr) {
    PartStore store({folder_ / name, "", "", 1e-9, std::chrono::steady_clock::now()}, progress_);
    return solve(room, params, {.keep = &store, .earlier = earlier});
  }
  RecordFile file(const std::string& name) {
    auto out = RecordFile::open(folder_ / name);
    EXPECT_TRUE(out) << out.error().message;
    return std::move(*out);
  }
  std::vector<RayTile> tiles(const std::string& name, const Room& room, uint64_t round = 0) {
    const RecordFile rays = file(name);
    std::vector<RayTile> out;
    const size_t n = room.elements.size();
    for (size_t tile = 0; tile < tile_count(n); ++tile) {
      RayTileBuffer buffer;
      const RayTile* found =
          find_rays(rays, round, tile, tile_size(n, tile), places_of(room), buffer);
      EXPECT_TRUE(found) << "tile " << tile;
      out.push_back(found ? *found : RayTile{});
    }
    return out;
  }
  /// Copies a file of one round with tiles changed, or left out where `edit` returns false.
  void copy(const std::string& from, const std::string& to, const Room& room,
            const std::function<bool(size_t, RayTile&)>& edit) {
    PartStore store({folder_ / to, "", "", 1e-9, std::chrono::steady_clock::now()}, progress_);
    std::vector<RayTile> all = tiles(from, room);
    for (size_t tile = 0; tile < all.size(); ++tile)
      if (edit(tile, all[tile])) keep_rays(&store, 0, tile, all[tile]);
    keep_samples(&store, 0, earlier_rounds(file(from), room.elements.size())->front());
  }

  Progress progress_;
};

/// The earlier bake of `before` for `now`, with boxes around moved instances.
inline Earlier earlier_of(const RecordFile& rays, const Room& before, const Room& now,
                          const Gather& light) {
  const size_t n = before.elements.size();
  Earlier out;
  out.rounds = *earlier_rounds(rays, n);
  out.rays.file = &rays;
  for (size_t i = 0; i < n; ++i)
    out.rays.moved.push_back(!(before.elements.position[i] == now.elements.position[i]));
  for (uint32_t k = 0; k < now.scene.instances.size(); ++k)
    if (!(before.scene.instances[k].world_from_object == now.scene.instances[k].world_from_object))
      for (const scene::Scene* scene : {&before.scene, &now.scene})
        out.rays.boxes.push_back(bounds_of(*scene, k));
  out.irradiance = light.irradiance;
  return out;
}

inline void expect_same_rays(std::span<const RayTile> a, std::span<const RayTile> b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t tile = 0; tile < a.size(); ++tile) {
    EXPECT_EQ(a[tile].ends, b[tile].ends) << tile;
    EXPECT_EQ(a[tile].hits.end, b[tile].hits.end) << tile;
    EXPECT_TRUE(std::ranges::equal(a[tile].hits.entries, b[tile].hits.entries,
                                   [](StoredHit x, StoredHit y) { return x.bits == y.bits; }))
        << tile;
    for (size_t i = 0; i < a[tile].escaped.size(); ++i) {
      const EscapedLight &x = a[tile].escaped[i], &y = b[tile].escaped[i];
      // Sums of at most 32 radiances below 1, of which some were added and taken away again: each
      // step rounds a sum below 32 to 24 bits, 2e-6, and there are 64 at most.
      constexpr float kRounding = 1.3e-4f;
      EXPECT_NEAR(luminance(x.sum), luminance(y.sum), kRounding);
      EXPECT_NEAR(x.luminance2, y.luminance2, kRounding);
      EXPECT_NEAR(x.second_luminance, y.second_luminance, kRounding);
    }
  }
}

/// Both have gone through the bounces to their tolerance, from different guesses: 1e-4 of the mean
/// each, and four times as much at single elements.
inline void expect_same_light(const Gather& a, const Gather& b) {
  ASSERT_EQ(a.irradiance.size(), b.irradiance.size());
  float mean = 0;
  for (const Rgb& e : b.irradiance) mean += luminance(e) / float(b.irradiance.size());
  for (size_t i = 0; i < a.irradiance.size(); ++i)
    ASSERT_LT(length(a.irradiance[i] - b.irradiance[i]), 8e-4f * mean) << i;
  EXPECT_EQ(a.direct, b.direct);
  EXPECT_EQ(a.met_back, b.met_back);
  EXPECT_EQ(a.enclosed, b.enclosed);
  EXPECT_EQ(a.samples, b.samples);
}

inline uint64_t count_of(std::span<const RayTile> tiles, RayEnd end) {
  uint64_t out = 0;
  for (const RayTile& tile : tiles) out += uint64_t(std::ranges::count(tile.ends, end));
  return out;
}

}  // namespace luxel::gather
