#include "luxel/transport/own_lookups.h"

#include <gtest/gtest.h>

#include "luxel/base/random.h"
#include "luxel/transport/floor_test_support.h"

namespace luxel::transport {
namespace {

/// Many places that are looked up together, with few texels remembered, so that they push each
/// other out, read what each reads alone.
TEST(OwnLookups, ManyReadWhatEachReadsAlone) {
  Floor floor;
  floor.add_box({0.99f, -0.1f, -1}, {1.0f, 1, 3});
  const trace::RayTracer rays = floor.tracer();
  const OwnSides sides = find_own_sides(floor.scene, floor.atlas, floor.map, rays);
  std::vector<scene::SurfacePoint> points;
  for (uint32_t k = 0; k < 4000; ++k) {
    Vec2 u = sobol_owen_2d(k, 1);
    if (u.x + u.y > 1) u = {1 - u.x, 1 - u.y};
    const scene::SurfacePoint p{0, k % 2, {u.x, u.y}};
    if (sides.is_mixed(lookup_place(floor.atlas, p).base)) points.push_back(p);
  }
  ASSERT_GT(points.size(), 100u);
  LookupBuffers buffers;
  buffers.known.resize(7);
  std::vector<LookupPlace> places(points.size());
  for (size_t first = 0; first < points.size(); first += 40) {
    const size_t count = std::min<size_t>(40, points.size() - first);
    own_lookups(sides, std::span(points).subspan(first, count), buffers,
                std::span(places).subspan(first, count));
  }
  for (size_t i = 0; i < points.size(); ++i) {
    const LookupPlace alone = own_lookup(sides, points[i]);
    EXPECT_EQ(places[i].base, alone.base);
    EXPECT_EQ(places[i].fx, alone.fx);
    EXPECT_EQ(places[i].fy, alone.fy);
  }
}

}  // namespace
}  // namespace luxel::transport
