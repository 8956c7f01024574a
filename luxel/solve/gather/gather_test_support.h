// Scenes laid out for tests of gather.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "luxel/solve/gather/gather.h"

namespace luxel::gather {

/// A scene, laid out and ready to be solved. Heap-allocated: parts point at each other.
struct Room {
  scene::Scene scene;
  atlas::Atlas atlas;
  atlas::TexelMap map;
  transport::Elements elements;
  light::Lights lights;
  std::optional<trace::RayTracer> tracer;
};

/// Sets all that follows from the room's scene and map.
inline void make_ready(Room& room) {
  room.elements = transport::elements_from_texels(room.scene, room.atlas, room.map);
  room.lights = light::collect_lights(room.scene);
  auto tracer = trace::RayTracer::build(room.scene);
  EXPECT_TRUE(tracer);
  room.tracer.emplace(std::move(*tracer));
}

/// Texels and elements lie in `memory` where there is one.
inline std::unique_ptr<Room> lay_out(scene::Scene scene, int resolution,
                                     std::shared_ptr<MappedMemory> memory = nullptr) {
  auto room = std::make_unique<Room>();
  room->scene = std::move(scene);
  Progress progress;
  atlas::AtlasParams params;
  params.resolution = resolution;
  params.uv = atlas::UvMode::unwrap;
  auto atlas = atlas::make_atlas(room->scene, params, progress);
  EXPECT_TRUE(atlas) << atlas.error().message;
  room->atlas = std::move(*atlas);
  room->map = atlas::rasterise(room->scene, room->atlas, std::move(memory));
  make_ready(*room);
  return room;
}

inline light::TexelScene scene_of(const Room& room) {
  return {room.scene, room.atlas, room.map, room.elements, room.lights, *room.tracer};
}

inline Gather solve(const Room& room, const GatherParams& params, const GatherStores& stores = {},
                    const light::LightLayers* layers = nullptr,
                    const GatherObserver& observer = {}) {
  Progress progress;
  auto result = gather(scene_of(room), layers, params, stores, observer, progress);
  EXPECT_TRUE(result) << result.error().message;
  return std::move(*result);
}

inline GatherParams with_samples(int samples, int direct_samples = 64) {
  GatherParams params;
  params.samples = samples, params.direct_samples = direct_samples;
  return params;
}

/// A test that has a folder, which goes with it.
class WithFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("luxel-gather-" + std::to_string(::getpid()) + "-" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

}  // namespace luxel::gather
