// Measured errors of light that is off by a known amount.
#include "luxel/pipeline/command/relight_error.h"

#include <gtest/gtest.h>

#include "luxel/scene/procedural.h"

namespace luxel::pipeline {
namespace {

// In a closed box whose walls all send B, E is B everywhere. Places that are given it and a tenth
// more or less are off by a tenth, however noisy paths are; with as many lamps whose light comes
// straight, that light is not part of it.
TEST(IndirectError, IsWhatLightIsOffBy) {
  constexpr float kReflectance = 0.5f;
  const Rgb exitance{1, 1, 1};
  scene::Scene scene = scene::furnace_box(Rgb{1, 1, 1} * kReflectance, exitance);
  const trace::RayTracer tracer = *trace::RayTracer::build(scene);
  const transport::Elements places = places_to_check(scene, 3);
  // Every surface's normal looks inwards.
  const reference::Receivers receivers{places.position, places.normal, places.geometric_normal, {}};
  const float known = kPi * scene.materials[0].emission.x / (1 - kReflectance);
  for (const float off : {0.0f, 0.1f}) {
    std::vector<Rgb> given;
    for (size_t i = 0; i < places.position.size(); ++i)
      given.push_back(Rgb{1, 1, 1} * (known * (i % 2 ? 1 + off : 1 - off)));
    Progress progress;
    progress.expect(stages_of_indirect_error(0));
    const auto error = indirect_error({scene, tracer, receivers, given, -1}, 256, 5, progress);
    ASSERT_TRUE(error) << error.error().message;
    EXPECT_EQ(error->places, places.position.size());
    EXPECT_GT(error->noise, 0.001);
    EXPECT_LT(error->noise, 0.1);
    EXPECT_NEAR(error->rms, off, 0.3 * error->noise + 0.002);
    EXPECT_NEAR(error->p95, off, 3 * error->noise);
    EXPECT_EQ(progress.stages().size(), 2u);
  }
}

TEST(IndirectError, StopsWhenAsked) {
  const scene::Scene scene = scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1});
  const trace::RayTracer tracer = *trace::RayTracer::build(scene);
  const transport::Elements places = places_to_check(scene, 3);
  const std::vector<Rgb> given(places.position.size());
  Progress progress;
  progress.request_cancel();
  const auto error = indirect_error(
      {scene, tracer, {places.position, places.normal, places.geometric_normal, {}}, given, -1},
      1 << 20, 5, progress);
  ASSERT_FALSE(error);
  EXPECT_EQ(error.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace luxel::pipeline
