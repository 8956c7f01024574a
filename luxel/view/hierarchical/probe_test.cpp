// Light of a square lamp at points of a floor, past a screen: all of it is known in closed form.
#include "luxel/view/hierarchical/probe.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "luxel/view/hierarchical/probe_test_support.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::lamp;

/// Where the screen's edge and the lamp's middle are in one line.
constexpr double kHalfSeen_m = testing::kScreenEdge_m * 2.5 / 1.5;

h::FacePoint on_floor(double x, double z) {
  return {testing::face_of(lamp().view(), testing::kFloor), {x, 0, z}};
}

double area_of(std::span<const DVec2> polygon) {
  double twice = 0;
  for (size_t k = 0; k < polygon.size(); ++k)
    twice += cross(polygon[k], polygon[(k + 1) % polygon.size()]);
  return 0.5 * twice;
}

TEST(LightProbe, IsThePolygonsFormFactorTimesItsRadiosity) {
  const SolutionView view = lamp().view();
  Progress progress;
  for (const auto& [x, z] : {std::pair{1.2, 0.3}, std::pair{0.45, 0.0}, std::pair{0.37, -0.2}}) {
    const double e = testing::light_at(x, z);
    const auto twice = [e](const h::FacePoint&) { return Rgb{1, 1, 1} * float(2 * e); };
    const auto probe = probe_light(view, on_floor(x, z), twice, progress);
    ASSERT_TRUE(probe);
    // Corners and the light are floats; a point is taken 1e-5 of the way to the floor's middle.
    EXPECT_NEAR(double(probe->exact.x), e, 1e-4 * e) << x;
    EXPECT_NEAR(probe->difference, 1, 1e-4);
    ASSERT_FALSE(probe->sources.empty());
    EXPECT_EQ(probe->sources[0].face, testing::face_of(view, testing::kLampFace));
    EXPECT_NEAR(probe->sources[0].share, 1, 1e-4);
    EXPECT_NEAR(probe->sources[0].form_factor, e / (M_PI * double(testing::kLampRadiance)),
                1e-4 * e);
    EXPECT_LT(max_component(probe->from_no_face), 1e-4f * float(e));
  }
}

TEST(LightProbe, SaysItInLines) {
  Progress progress;
  const auto grey = [](const h::FacePoint&) { return Rgb{0.5f, 0.5f, 0.5f}; };
  const auto probe = probe_light(lamp().view(), on_floor(1.2, 0.3), grey, progress);
  ASSERT_TRUE(probe);
  const std::vector<std::string> lines = lines_of(*probe, "W/m^2", {});
  EXPECT_THAT(lines, Contains(HasSubstr("1.200 0.000 0.300")));
  EXPECT_THAT(lines_of(*probe, "", {1e6, 0, -2e6}),
              Contains(HasSubstr("1000001.200 0.000 -1999999.700")));
  EXPECT_THAT(lines, Contains(HasSubstr("100.0 %")));
  EXPECT_THAT(lines, Contains("as shown 0.5 W/m^2"));
}

TEST(BackprojectionProbe, SeesTheHalfOfALampThatNothingHides) {
  const SolutionView view = lamp().view();
  Progress progress;
  const auto probe = probe_sources(view, on_floor(kHalfSeen_m, 0), 4, progress);
  ASSERT_TRUE(probe);
  ASSERT_EQ(probe->sources.size(), 1u);
  const SeenSource& source = probe->sources[0];
  EXPECT_NEAR(source.visible_area, 0.5, 2e-4);
  // A little more of the nearer half is seen than of the whole.
  const double half = double(testing::kLampHalf_m);
  const double all = testing::factor_of_rectangle(kHalfSeen_m, 0, -half, half, -half, half);
  const double seen = testing::factor_of_rectangle(kHalfSeen_m, 0, 0, half, -half, half);
  EXPECT_NEAR(source.of.visible, seen / all, 2e-4);
  EXPECT_GT(source.of.visible, 0.5);
  // The picture of it: as large, counter-clockwise, and the half that is seen on one side.
  EXPECT_NEAR(area_of(source.flat_outline), 4 * half * half, 1e-6);
  double flat_seen = 0;
  for (const auto& part : source.flat_visible) {
    EXPECT_GT(area_of(part), 0);
    flat_seen += area_of(part);
  }
  EXPECT_NEAR(flat_seen, 2 * half * half, 1e-5);
  for (const auto& part : source.visible)
    for (const DVec3& p : part) EXPECT_GT(p.x, -1e-4);
  EXPECT_THAT(lines_of(source, ""), Contains(HasSubstr("50.0")));
}

TEST(BackprojectionProbe, SeesAllOrNothingBesideThePenumbra) {
  const SolutionView view = lamp().view();
  Progress progress;
  const auto lit = probe_sources(view, on_floor(1.5, 0), 4, progress);
  ASSERT_TRUE(lit);
  ASSERT_EQ(lit->sources.size(), 1u);
  EXPECT_NEAR(lit->sources[0].visible_area, 1, 1e-9);
  const auto dark = probe_sources(view, on_floor(0.3, 0), 4, progress);
  ASSERT_TRUE(dark);
  EXPECT_TRUE(dark->sources.empty());
  const auto none = probe_sources(view, on_floor(1.5, 0), 0, progress);
  ASSERT_TRUE(none);
  EXPECT_EQ(none->left_out, 1u);
}

TEST(Probes, CanBeCancelled) {
  Progress progress;
  progress.request_cancel();
  const auto none = [](const h::FacePoint&) { return Rgb{}; };
  EXPECT_FALSE(probe_light(lamp().view(), on_floor(1, 0), none, progress));
  EXPECT_FALSE(probe_sources(lamp().view(), on_floor(1, 0), 4, progress));
}

}  // namespace
}  // namespace luxel::view
