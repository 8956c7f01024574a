#include "luxel/pipeline/command/work_plane.h"

#include <gtest/gtest.h>

#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

// A field of 4 km and 2 cm over it a sheet that shows its underside: what lies so close below
// another surface is met, however long the scene.
TEST(WorkPlane, MeetsTheFloorUnderASheetInALongScene) {
  scene::Scene scene;
  const uint32_t grey = scene::add_material(scene, "grey", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {-2000, 2000, -200, 200}, 0, true, grey);
  scene::add_rectangle(scene, {-2000, 2000, -200, 200}, 0.02f, false, grey);
  const auto tracer = trace::RayTracer::build(scene);
  ASSERT_TRUE(tracer);
  Progress progress;
  WorkPlaneParams params;
  params.floors = {0}, params.spacing_m = 10;
  const auto floors = find_work_planes(scene, *tracer, params, progress);
  ASSERT_TRUE(floors) << floors.error().message;
  ASSERT_EQ(floors->size(), 1u);
  ASSERT_FALSE(floors->front().points.empty());
  for (const PlanePoint& p : floors->front().points) EXPECT_NEAR(p.position.y, 0.85f, 1e-5f);
}

}  // namespace
}  // namespace luxel::pipeline
