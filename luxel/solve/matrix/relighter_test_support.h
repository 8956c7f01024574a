// Helpers for tests of relighting: a scene prepared, lamps, and places to light.
#pragma once

#include <gtest/gtest.h>

#include "luxel/scene/off_surface.h"
#include "luxel/solve/matrix/matrix_test_support.h"
#include "luxel/solve/matrix/relight.h"
#include "luxel/solve/matrix/relighter.h"

namespace luxel::matrix::testing {

inline constexpr std::array kAllCodecs{CodecKind::hierarchical, CodecKind::lowrank, CodecKind::bc1,
                                       CodecKind::dense32, CodecKind::dense16};

inline RelightParams small(CodecKind codec, float max_error = 0.01f) {
  RelightParams params;
  params.patches.count = 300;
  params.factors.rays_per_patch = 512;
  params.codec = codec, params.max_error = max_error;
  return params;
}

/// A scene and what relights it.
struct Stage {
  scene::Scene scene;
  trace::RayTracer tracer;
  RelightParams params;

  explicit Stage(scene::Scene s, const RelightParams& p = small(CodecKind::dense32, 1e-4f))
      : scene(std::move(s)), tracer(*trace::RayTracer::build(scene)), params(p) {}

  RelightData data(Target target = {}) const {
    Progress progress;
    auto out = make_relight_data(scene, tracer, std::move(target), params, progress);
    EXPECT_TRUE(out) << out.error().message;
    return out ? std::move(*out) : RelightData{};
  }
};

inline Relighter relighter_of(RelightData data, const RelighterParams& params = {}) {
  auto made = Relighter::make(std::move(data), params);
  EXPECT_TRUE(made) << made.error().message;
  return std::move(*made);
}

inline Relit relit(Relighter& relighter, const RelightLights& lights) {
  relighter.update(lights);
  return relighter.latest();
}

inline scene::PunctualLight point_at(Vec3 position, Rgb intensity) {
  scene::PunctualLight lamp;
  lamp.position = position, lamp.intensity = intensity;
  return lamp;
}
/// Both hang free in the Cornell box.
inline const scene::PunctualLight kLeft = point_at({0.45f, 0.4f, 0.15f}, {1, 0.5f, 0.25f});
inline const scene::PunctualLight kRight = point_at({0.1f, 0.45f, 0.4f}, {0.25f, 1, 0.5f});

/// Squares on the floor, facing up.
inline Target floor_places(float side_m) {
  Target target;
  target.kind = Target::Kind::vertices;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i)
      target.position.push_back(scene::off_surface(
          {side_m * (float(i) + 0.5f) / 8, 0, side_m * (float(j) + 0.5f) / 8}, {0, 1, 0}, 1));
  target.normal.assign(target.position.size(), {0, 1, 0});
  target.geometric_normal = target.normal;
  return target;
}

}  // namespace luxel::matrix::testing
