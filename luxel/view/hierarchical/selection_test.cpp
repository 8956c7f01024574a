// Facts about elements, links, triangles and discontinuities of a lamp over a floor.
#include "luxel/view/hierarchical/selection_facts.h"

#include <gmock/gmock.h>

#include "luxel/view/hierarchical/probe_test_support.h"
#include "luxel/view/hierarchical/selection_shapes.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::lamp;

uint32_t floor_of_lamp() { return testing::face_of(lamp().view(), testing::kFloor); }

/// All that fall on the floor.
std::vector<h::Discontinuity> lines_on_floor() {
  const SolutionView view = lamp().view();
  return h::find_discontinuities(view.solution, view.scene, view.tracer, floor_of_lamp(),
                                 h::Ranking::slope, {0, 0});
}

TEST(SelectedElement, KnowsItsTreeItsLightAndItsLinks) {
  const SolutionView view = lamp().view();
  const std::vector<uint32_t> path = path_to(view, {floor_of_lamp(), {0.4, 0, 0.1}});
  size_t links = 0;
  bool has_links = false;
  double area = INFINITY;
  for (size_t level = 0; level < path.size(); ++level) {
    const NodeFacts facts = facts_of(view, path, level);
    EXPECT_EQ(facts.links_above, links);
    EXPECT_EQ(facts.links, view.solution.links.of[path[level]].size());
    links += facts.links;
    EXPECT_LE(facts.area_m2, area * (1 + 1e-9));
    area = facts.area_m2;
    if (facts.is_cluster || facts.links == 0) continue;
    has_links = true;
    // Light of the links one by one adds up to that of the last gather.
    Rgb sum{};
    for (const h::Link& link : view.solution.links.of[path[level]])
      sum += h::irradiance_of(link, view.solution.exchange(view.tracer), view.solution.light);
    EXPECT_NEAR(facts.over_links.x, sum.x, 2e-3f * sum.x);
  }
  EXPECT_TRUE(has_links);
  const NodeFacts leaf = facts_of(view, path, path.size() - 1);
  EXPECT_EQ(leaf.leaves, 1u);
  EXPECT_EQ(leaf.height, 0u);
  EXPECT_NEAR(leaf.reflectance.x, 0.5, 1e-6);
  EXPECT_NEAR(leaf.radiosity.x, 0.5f * leaf.irradiance.x, 1e-6f);
  EXPECT_THAT(lines_of(leaf, "W/m^2"), Contains(HasSubstr("reflectance 0.5")));
}

TEST(SelectedLink, HasTheFormFactorOfItsEnds) {
  const SolutionView view = lamp().view();
  const h::Tree& tree = view.solution.tree;
  size_t looked = 0;
  for (uint32_t id = uint32_t(tree.clusters.size()); id < tree.size(); ++id)
    for (uint32_t k = 0; k < view.solution.links.of[id].size(); ++k) {
      const LinkFacts facts = facts_of(view, LinkNumber{id, k});
      if (facts.is_far || tree.element(id).face != floor_of_lamp() || facts.visible < 1) continue;
      // Far from the lamp and small before it: the mean is about that of the middle.
      const h::Element& e = tree.element(id);
      if (e.radius_m > 0.2) continue;
      const h::Element& s = tree.element(view.solution.links.of[id][k].source);
      double x0 = INFINITY, x1 = -INFINITY, z0 = INFINITY, z1 = -INFINITY;
      for (const DVec3& p : s.polygon()) {
        x0 = std::min(x0, p.x), x1 = std::max(x1, p.x);
        z0 = std::min(z0, p.z), z1 = std::max(z1, p.z);
      }
      const double factor = testing::factor_of_rectangle(e.centre.x, e.centre.z, x0, x1, z0, z1);
      EXPECT_NEAR(facts.form_factor, factor, 0.02 * factor);
      EXPECT_NEAR(double(facts.irradiance.x), factor * M_PI * double(testing::kLampRadiance),
                  0.02 * factor * M_PI * double(testing::kLampRadiance));
      ++looked;
    }
  EXPECT_GT(looked, 0u);
}

TEST(SelectedLink, HasTheBlockersOfItsShaft) {
  const SolutionView view = lamp().view();
  const h::Tree& tree = view.solution.tree;
  const uint32_t screen = testing::face_of(view, testing::kScreen);
  size_t hidden = 0;
  for (uint32_t id = uint32_t(tree.clusters.size()); id < tree.size(); ++id)
    for (uint32_t k = 0; k < view.solution.links.of[id].size(); ++k) {
      const LinkFacts facts = facts_of(view, LinkNumber{id, k});
      if (facts.is_far || facts.visible >= 1) continue;
      EXPECT_THAT(facts.blockers, Contains(screen));
      EXPECT_THAT(lines_of(facts, ""), Contains(HasSubstr("1 face in its shaft")));
      SelectionShapes shapes;
      add_link(view, {id, k}, shapes);
      const auto red = std::count_if(shapes.lines.begin(), shapes.lines.end(), [](const auto& l) {
        return l.color.x > 0.9f && l.color.y < 0.3f;
      });
      EXPECT_EQ(red, 4);
      ++hidden;
    }
  EXPECT_GT(hidden, 0u);
}

TEST(Shaft, OfTwoSquaresHasFourSidesOrEight) {
  const h::Polygon a{{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}};
  const h::Polygon b{{-1, 3, -1}, {1, 3, -1}, {1, 3, 1}, {-1, 3, 1}};
  const auto straight = shaft_edges(a, b, 1e-6);
  EXPECT_EQ(straight.size(), 4u);
  for (const auto& edge : straight) {
    EXPECT_NEAR(edge[0].x, edge[1].x, 1e-12);
    EXPECT_NEAR(edge[0].z, edge[1].z, 1e-12);
  }
  // Turned by an eighth: every corner of one sees two of the other, as in an antiprism.
  const double r = std::sqrt(2.0);
  const h::Polygon turned{{-r, 3, 0}, {0, 3, -r}, {r, 3, 0}, {0, 3, r}};
  EXPECT_EQ(shaft_edges(a, turned, 1e-6).size(), 8u);
}

TEST(SelectedTriangle, HasTheLightOfItsSixSamples) {
  const SolutionView view = lamp().view();
  const auto triangle = triangle_at(view, {floor_of_lamp(), {0.9, 0, 0.13}});
  ASSERT_TRUE(triangle);
  const TriangleFacts facts = triangle_facts(view, *triangle);
  for (size_t k = 0; k < 3; ++k) {
    const DVec3 p = facts.corner[k], q = (p + facts.corner[(k + 1) % 3]) * 0.5;
    EXPECT_NEAR(double(facts.value[2 * k].x), testing::light_at(p.x, p.z), 1e-3);
    EXPECT_NEAR(double(facts.value[2 * k + 1].x), testing::light_at(q.x, q.z), 1e-3);
  }
  EXPECT_EQ(view.solution.tree.elements[facts.leaf].face, floor_of_lamp());
}

// A ray past the screen's edge to an edge of the lamp: x = 0.25 + (0.25 -+ 0.1) / 1.5.
TEST(SelectedDiscontinuity, HasTheCornersAndEdgesThatMakeIt) {
  const SolutionView view = lamp().view();
  size_t of_ve = 0, of_ev = 0;
  for (const h::Discontinuity& line : lines_on_floor()) {
    for (const double lamp_x : {0.1, -0.1}) {
      const double x = 0.25 + (0.25 - lamp_x) / 1.5;
      if (std::abs(line.a.x - x) > 1e-5 || std::abs(line.b.x - x) > 1e-5) continue;
      const DiscontinuityFacts facts = facts_of(view, floor_of_lamp(), line);
      ASSERT_TRUE(facts.at_source && facts.at_blocker);
      for (const DVec3& p : {facts.at_source->from, facts.at_source->to})
        EXPECT_NEAR(p.x, lamp_x, 1e-6);
      for (const DVec3& p : {facts.at_blocker->from, facts.at_blocker->to})
        EXPECT_NEAR(p.x, 0.25, 1e-6);
      // Both edges are parallel: the lamp appears all along its edge, and the slope jumps.
      EXPECT_EQ(facts.degree, 1);
      EXPECT_EQ(facts.at_source->is_edge(), line.kind == h::DiscontinuityKind::ev);
      EXPECT_EQ(facts.at_blocker->is_edge(), line.kind == h::DiscontinuityKind::ve);
      (line.kind == h::DiscontinuityKind::ve ? of_ve : of_ev) += 1;
      EXPECT_GT(facts.weight, 0);
    }
  }
  EXPECT_GT(of_ve, 0u);
  EXPECT_GT(of_ev, 0u);
}

// The lamp turned by an eighth shows a corner first, and its area grows by the square.
TEST(SelectedDiscontinuity, OfACornerIsOfTheSecondDegree) {
  scene::Scene scene = h::testing::lamp_and_screen(0.1f, 10);
  const Mat34 turn = [] {
    Mat34 m;
    const float r = std::sqrt(0.5f);
    m.row[0] = {r, 0, r, 0}, m.row[1] = {0, 1, 0, 0}, m.row[2] = {-r, 0, r, 0};
    return m;
  }();
  scene.instances[testing::kLampFace].world_from_object = turn;
  const auto s = h::testing::solved(std::move(scene));
  const SolutionView view{s->scene, *s->tracer, s->solution};
  const uint32_t floor = testing::face_of(view, testing::kFloor);
  size_t looked = 0;
  for (const h::Discontinuity& line : h::find_discontinuities(s->solution, s->scene, *s->tracer,
                                                              floor, h::Ranking::slope, {0, 0})) {
    if (line.kind != h::DiscontinuityKind::ve || std::abs(line.a.x - line.b.x) > 1e-6) continue;
    EXPECT_EQ(facts_of(view, floor, line).degree, 2);
    ++looked;
  }
  EXPECT_GT(looked, 0u);
}

TEST(SelectedDiscontinuity, OfAPointLampAndOfAContactIsAJump) {
  scene::Scene scene = h::testing::lamp_and_screen(0.1f, 10);
  scene::PunctualLight light;
  light.kind = scene::PunctualLight::Kind::point, light.position = {0, 2, 0},
  light.intensity = {9, 9, 9};
  scene.lights.push_back(light);
  const uint32_t grey = scene::add_material(scene, "wall", {0.5f, 0.5f, 0.5f});
  h::testing::add_polygon(scene, "wall", {{1, 0, -1}, {1, 0, 1}, {1, 1, 1}, {1, 1, -1}}, grey);
  const auto s = h::testing::solved(std::move(scene));
  const SolutionView view{s->scene, *s->tracer, s->solution};
  const uint32_t floor = testing::face_of(view, testing::kFloor);
  size_t of_point = 0, of_contact = 0;
  for (const h::Discontinuity& line : h::find_discontinuities(s->solution, s->scene, *s->tracer,
                                                              floor, h::Ranking::slope, {0, 0})) {
    const DiscontinuityFacts facts = facts_of(view, floor, line);
    if (line.kind == h::DiscontinuityKind::contact) {
      EXPECT_EQ(facts.degree, 0);
      EXPECT_FALSE(facts.at_source || facts.at_blocker);
      ++of_contact;
    } else if (line.source >= h::kPunctualSource) {
      EXPECT_EQ(facts.degree, 0);
      ASSERT_TRUE(facts.at_source);
      EXPECT_FALSE(facts.at_source->is_edge());
      EXPECT_NEAR(facts.at_source->from.y, 2, 1e-6);
      ++of_point;
    }
  }
  EXPECT_GT(of_point, 0u);
  EXPECT_GT(of_contact, 0u);
}

}  // namespace
}  // namespace luxel::view
