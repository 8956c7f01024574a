#include "luxel/transport/back_faces.h"

#include <gtest/gtest.h>

#include "luxel/scene/off_surface.h"
#include "luxel/scene/shapes.h"

namespace luxel::transport {
namespace {

constexpr float kHeight = 3, kHalf = 0.25f;  ///< of a pillar, which the ceiling lies on [m]

/// A floor and a ceiling, and a pillar between them whose caps lie as high, but for a hair's
/// breadth, by which it is the floor that rays meet. `lamp`: of what shines on the floor within the
/// pillar.
scene::Scene hall(Rgb lamp) {
  scene::Scene scene;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene.materials[gray].double_sided = true;
  scene::add_rectangle(scene, {-3, 3, -3, 3}, 1e-5f, true, gray);
  scene::add_rectangle(scene, {-3, 3, -3, 3}, kHeight, false, gray);
  scene::Mesh pillar;
  pillar.name = "pillar";
  scene::add_box(pillar, {-kHalf, 0, -kHalf}, {kHalf, kHeight, kHalf}, gray);
  scene::place(scene, std::move(pillar));
  if (max_component(lamp) > 0) {
    const uint32_t shining = scene::add_material(scene, "lamp", {}, lamp);
    scene::add_rectangle(scene, {-0.2f, 0.2f, -0.2f, 0.2f}, kHeight - 0.3f, true, shining);
  }
  return scene;
}

/// Enclosed places of the ceiling, within the pillar and outside of it, of `each` that were tried.
struct Counts {
  int inside = 0, outside = 0, each = 0;
};
Counts count_enclosed(const scene::Scene& scene, int rays) {
  const auto tracer = trace::RayTracer::build(scene);
  EXPECT_TRUE(tracer);
  Counts out;
  for (int k = 0; k < 20; ++k)
    for (int j = 0; j < 20; ++j, ++out.each) {
      const float x = kHalf * (float(2 * k + 1) / 20 - 1), z = kHalf * (float(2 * j + 1) / 20 - 1);
      const auto is_enclosed_at = [&](float at_x) {
        const Vec3 down{0, -1, 0};
        const Vec3 from = scene::off_surface({at_x, kHeight, z}, down, 1);
        return is_enclosed(scene, *tracer, from, down, rays);
      };
      out.inside += is_enclosed_at(x), out.outside += is_enclosed_at(x + 3 * kHalf);
    }
  return out;
}

// The walls take up 99 % of the view, the floor or the pillar's own bottom the rest.
TEST(BackFaces, APlaceWithinAPillarOnTheFloorIsEnclosed) {
  const scene::Scene scene = hall({});
  for (const int rays : {16, 32, 64}) {
    const Counts counts = count_enclosed(scene, rays);
    EXPECT_EQ(counts.inside, counts.each) << rays;
    EXPECT_EQ(counts.outside, 0) << rays;
  }
}

// Where something shines it is not dark.
TEST(BackFaces, APlaceThatSeesALampIsNot) {
  const Counts counts = count_enclosed(hall({5, 5, 5}), 64);
  EXPECT_LT(counts.inside, counts.each / 2);
  EXPECT_EQ(counts.outside, 0);
}

}  // namespace
}  // namespace luxel::transport
