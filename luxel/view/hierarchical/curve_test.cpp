// Curves of light where it is known in closed form.
#include "luxel/view/hierarchical/curve.h"

#include "luxel/view/hierarchical/probe_test_support.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;
using testing::lamp;

uint32_t floor_face() { return testing::face_of(lamp().view(), testing::kFloor); }

/// A floor under a sky of radiance 1 / pi: E is 1 everywhere.
const h::testing::Solved& under_the_sky() {
  static const auto made = [] {
    scene::Scene scene;
    scene.background = {1 / kPi, 1 / kPi, 1 / kPi};
    const uint32_t grey = scene::add_material(scene, "grey", {0.5f, 0.5f, 0.5f});
    scene::add_rectangle(scene, {-1, 1, -1, 1}, 0, true, grey);
    return h::testing::solved(std::move(scene));
  }();
  return *made;
}

// Past a screen's edge light rises from nothing over the penumbra.
TEST(Curve, FollowsTheLampThroughItsPenumbra) {
  Progress progress;
  const CurveLine line{floor_face(), {0.2, 0, 0}, {0.7, 0, 0}};
  const auto half = [](const h::FacePoint& at) {
    return Rgb{1, 1, 1} * float(0.5 * testing::light_at(at.position.x, 0));
  };
  const auto curve = curve_along(lamp().view(), line, half, {}, progress);
  ASSERT_TRUE(curve);
  ASSERT_GE(curve->exact.size(), 128u);
  double squares = 0, most = 0, sum = 0;
  for (size_t k = 0; k < curve->exact.size(); ++k) {
    const double x = 0.2 + double(curve->at_m[k]), e = testing::light_at(x, 0);
    EXPECT_NEAR(double(curve->exact[k].x), e, 2e-4) << x;
    squares += e * e / 4, most = std::max(most, e / 2), sum += e;
  }
  const auto count = double(curve->exact.size());
  EXPECT_NEAR(curve->rms, std::sqrt(squares / count), 2e-4);
  EXPECT_NEAR(curve->most, most, 2e-4);
  EXPECT_NEAR(curve->relative_rms, std::sqrt(squares / count) / (sum / count), 1e-3);
  EXPECT_EQ(curve->exact.front().x, 0);
  EXPECT_GT(curve->exact.back().x, 0.05f);
}

TEST(Curve, OfAFieldThatIsShownAsItIsHasNoError) {
  const h::testing::Solved& s = under_the_sky();
  Progress progress;
  const auto mesh = h::make_light_mesh(s.solution, s.scene, *s.tracer, {}, progress);
  ASSERT_TRUE(mesh);
  const SolutionView view{s.scene, *s.tracer, s.solution, &*mesh};
  const CurveLine line{0, {-0.9, 0, -0.5}, {0.7, 0, 0.8}};
  const auto even = curve_along(view, line, quadratic_light(view), {}, progress);
  ASSERT_TRUE(even);
  EXPECT_LT(even->most, 1e-5);
  for (const Rgb& e : even->exact) EXPECT_NEAR(e.x, 1, 1e-5f);
  // Shown by too much, in proportion to the way along the line: RMS of the way is 1 / sqrt 3.
  const auto more = [&](const h::FacePoint& at) {
    const double t = length(at.position - line.from) / length(line.to - line.from);
    return Rgb{1, 1, 1} * float(1 + 0.1 * t);
  };
  const auto off = curve_along(view, line, more, {}, progress);
  ASSERT_TRUE(off);
  EXPECT_NEAR(off->rms, 0.1 / std::sqrt(3.0), 1e-4);
  EXPECT_NEAR(off->most, 0.1, 1e-3);
}

TEST(Curve, InterpolantsAreExactAtTheirSamples) {
  const SolutionView view = lamp().view();
  const ShownLight shown = quadratic_light(view);
  size_t looked = 0;
  for (const h::LightTriangle& t : view.mesh->triangles) {
    const DVec3 a = view.mesh->vertices[t.vertex[0]], b = view.mesh->vertices[t.vertex[1]];
    const DVec3 middle = (a + b) * 0.5 + (h::middle_of(*view.mesh, t) - (a + b) * 0.5) * 1e-6;
    if (t.face != floor_face() || std::abs(middle.z) > 0.8 || middle.x < 0.26) continue;
    const double e = testing::light_at(middle.x, middle.z);
    EXPECT_NEAR(double(shown({t.face, middle}).x), e, 1e-3) << middle.x << " " << middle.z;
    ++looked;
  }
  EXPECT_GT(looked, 20u);
}

// Linear light has the corners' values, and halfway along an edge the mean of its ends.
TEST(Curve, ShowsLightFlatAndLinear) {
  const SolutionView view = lamp().view();
  const ShownLight linear = linear_light(view), flat = light_of_leaves(view);
  size_t looked = 0;
  for (const h::LightTriangle& t : view.mesh->triangles) {
    const DVec3 a = view.mesh->vertices[t.vertex[0]], b = view.mesh->vertices[t.vertex[1]];
    if (t.face != floor_face() || std::abs(a.z) > 0.8 || std::abs(b.z) > 0.8 || a.x < 0.26 ||
        b.x < 0.26)
      continue;
    const double mean = (testing::light_at(a.x, a.z) + testing::light_at(b.x, b.z)) / 2;
    const DVec3 edge = (a + b) * 0.5, middle = h::middle_of(*view.mesh, t);
    EXPECT_NEAR(double(linear({t.face, edge + (middle - edge) * 1e-6}).x), mean, 1e-3);
    // Another place of the leaf has the leaf's light, too.
    EXPECT_EQ(flat({t.face, middle}).x, flat({t.face, middle + (a - middle) * 0.5}).x);
    ++looked;
  }
  EXPECT_GT(looked, 20u);
}

TEST(CurveLine, EndsWhereItsFaceEnds) {
  const SolutionView view = lamp().view();
  const auto line = clipped(view, {floor_face(), {0, 0.3, 0}, {5, -0.1, 0}});
  ASSERT_TRUE(line);
  EXPECT_NEAR(line->from.x, 0, 1e-9);
  EXPECT_NEAR(line->from.y, 0, 1e-9);
  EXPECT_NEAR(line->to.x, 2.5, 1e-6);
  EXPECT_FALSE(clipped(view, {floor_face(), {3, 0, 0}, {5, 0, 0}}));
  // Along the longest edge of a rectangle of 2 m by 1 m, through its middle.
  const h::Polygon polygon{{0, 0, 0}, {0, 0, 1}, {2, 0, 1}, {2, 0, 0}};
  const CurveLine across = line_across(polygon, floor_face());
  EXPECT_NEAR(length(across.to - across.from), 2, 1e-9);
  EXPECT_NEAR(across.from.z, 0.5, 1e-9);
  // At right angles to a discontinuity.
  h::Discontinuity edge;
  edge.a = {0.35, 0, -1}, edge.b = {0.35, 0, 1};
  const auto normal = line_across(view, floor_face(), edge, 0.25);
  ASSERT_TRUE(normal);
  EXPECT_NEAR(std::abs(normal->to.x - normal->from.x), 0.5, 1e-9);
  EXPECT_NEAR(std::max(normal->to.x, normal->from.x), 0.6, 1e-9);
}

TEST(LightSurface, IsAGridOverAnElement) {
  const SolutionView view = lamp().view();
  const h::Polygon square{{1, 0, 0}, {1, 0, 0.4}, {1.4, 0, 0.4}, {1.4, 0, 0}};
  const auto none = [](const h::FacePoint&) { return Rgb{}; };
  Progress progress;
  const auto grid = surface_over(view, square, floor_face(), 4, none, {1e-5}, progress);
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->places.size(), 25u);
  EXPECT_EQ(grid->edges.size(), 40u);
  for (size_t k = 0; k < grid->places.size(); ++k)
    EXPECT_NEAR(double(grid->exact[k].x), testing::light_at(grid->places[k].x, grid->places[k].z),
                2e-4);
  const auto triangle =
      surface_over(view, std::span(square).first(3), floor_face(), 4, none, {1e-5}, progress);
  ASSERT_TRUE(triangle);
  EXPECT_EQ(triangle->places.size(), 15u);
  EXPECT_EQ(triangle->edges.size(), 20u);
}

}  // namespace
}  // namespace luxel::view
