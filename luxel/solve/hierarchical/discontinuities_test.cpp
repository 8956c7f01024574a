#include "luxel/solve/hierarchical/discontinuities.h"

#include "luxel/solve/hierarchical/dsets.h"
#include "luxel/solve/hierarchical/hierarchical_test_support.h"

namespace luxel::hierarchical {
namespace {

using testing::Solved;
using testing::solved;

/// A lamp 1 m wide: each of its corners throws a shadow of its own.
scene::Scene lamp_and_screen() { return testing::lamp_and_screen(0.5f, 30); }

std::vector<Discontinuity> on_floor(const Solved& s, const DiscontinuityParams& params = {}) {
  return find_discontinuities(s.solution, s.scene, *s.tracer, s.solution.faces.face_of_triangle[0],
                              params.ranking, limits_of(s.solution, params));
}

/// The number of discontinuities on x = `x`, and the range of their z.
struct OnLine {
  int count = 0;
  double low = INFINITY, high = -INFINITY;
};
OnLine on_x(const std::vector<Discontinuity>& found, DiscontinuityKind kind, double x) {
  OnLine out;
  for (const Discontinuity& d : found) {
    if (d.kind != kind || std::abs(d.a.x - x) > 1e-6 || std::abs(d.b.x - x) > 1e-6) continue;
    ++out.count;
    out.low = std::min({out.low, d.a.z, d.b.z}), out.high = std::max({out.high, d.a.z, d.b.z});
  }
  return out;
}

// From a corner of the lamp at (vx, 2.5) the screen's edge at (0.25, 1) falls on
// x = 0.25 + (0.25 - vx) / 1.5, and its ends at z = +-1 on z + (z - vz) / 1.5.
TEST(Discontinuities, ShadowsOfAnEdgeFallWhereTheyDo) {
  const auto s = solved(lamp_and_screen(), {.eps = 1});
  DiscontinuityParams all;
  all.least_weight = 0;
  const auto found = on_floor(*s, all);
  for (const double vx : {-0.5, 0.5}) {
    const OnLine line = on_x(found, DiscontinuityKind::ve, 0.25 + (0.25 - vx) / 1.5);
    EXPECT_GE(line.count, 2) << vx;  // both corners of that side
    EXPECT_NEAR(line.low, -1 + (-1 - 0.5) / 1.5, 1e-6);
    EXPECT_NEAR(line.high, 1 + (1 + 0.5) / 1.5, 1e-6);
  }
  // The screen's corner from the lamp's edge x = 0.5: the same line, as far as that edge reaches.
  const OnLine ev = on_x(found, DiscontinuityKind::ev, 0.25 + (0.25 - 0.5) / 1.5);
  EXPECT_GE(ev.count, 2);
  for (const Discontinuity& d : found) {
    EXPECT_NEAR(d.a.y, 0, 1e-9);
    EXPECT_LE(std::abs(d.a.x), 2.5 + 1e-9);
    EXPECT_GT(length(d.b - d.a), 0);
  }
}

// d_sb / d_br along any ray over the edge is 1.5 / 1.
TEST(Discontinuities, NearnessIsTheRatioOfDistances) {
  const auto s = solved(lamp_and_screen(), {.eps = 1});
  DiscontinuityParams params;
  params.ranking = Ranking::nearness;
  params.least_weight = 0;
  for (const Discontinuity& d : on_floor(*s, params)) {
    if (d.kind != DiscontinuityKind::ve && d.kind != DiscontinuityKind::ev) continue;
    EXPECT_NEAR(d.geometric, 1.5, 1e-4);
    EXPECT_NEAR(weight_of(d, s->solution, s->scene), 1.5 * 30 * M_PI, 0.1);
  }
}

// A wall that shines towards +x from 1 m above the floor on: the floor's part behind its plane sees
// nothing of it.
TEST(Discontinuities, TheHorizonIsWhereASourcesPlaneCutsTheFloor) {
  scene::Scene scene;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  const uint32_t lamp = scene::add_material(scene, "lamp", {0, 0, 0}, {30, 30, 30});
  scene::add_rectangle(scene, {-2.5f, 2.5f, -2.5f, 2.5f}, 0, true, gray);
  testing::add_polygon(scene, "wall", {{0.5, 1, 1}, {0.5, 1, -1}, {0.5, 2, -1}, {0.5, 2, 1}}, lamp);
  const auto s = solved(std::move(scene), {.eps = 1});
  const OnLine line = on_x(on_floor(*s), DiscontinuityKind::horizon, 0.5);
  EXPECT_EQ(line.count, 1);
  EXPECT_NEAR(line.low, -2.5, 1e-6);
  EXPECT_NEAR(line.high, 2.5, 1e-6);
}

// A box that stands on the floor touches it along four edges; one that goes through it, too.
TEST(Discontinuities, ContactsAreTheFeetOfBoxes) {
  for (const float bottom : {0.0f, -0.3f}) {
    scene::Scene scene = lamp_and_screen();
    scene::Mesh box;
    scene::add_box(box, {-1.25f, bottom, 1.25f}, {-0.75f, 0.5f, 2.0f}, 0);
    box.name = "box";
    scene::place(scene, std::move(box));
    const auto s = solved(std::move(scene), {.eps = 1});
    double perimeter = 0;
    for (const Discontinuity& d : on_floor(*s)) {
      if (d.kind != DiscontinuityKind::contact) continue;
      EXPECT_TRUE(std::isinf(weight_of(d, s->solution, s->scene)));
      perimeter += length(d.b - d.a);
    }
    // Ends reach a rounding of floats beyond corners, so that they meet: 1e-6 of the scene's size.
    EXPECT_NEAR(perimeter, 2 * (0.5 + 0.75), 4e-5) << bottom;
  }
}

TEST(DSets, CollinearOnesAreOne) {
  Face face;
  face.corners = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  face.plane = viewfactor::plane_of(face.corners);
  const FacePlane plane = plane_coordinates(face);
  std::vector<Discontinuity> all(4);
  all[0].a = {1, 1, 0}, all[0].b = {2, 2, 0};
  all[1].a = {3, 3, 0}, all[1].b = {1.5, 1.5, 0};
  all[2].a = {1, 2, 0}, all[2].b = {2, 3, 0};  // beside it
  all[3].a = {0, 3, 0}, all[3].b = {3, 0, 0};  // across it
  const auto sets = make_dsets(all, plane, 1e-6);
  ASSERT_EQ(sets.size(), 3u);
  size_t largest = 0;
  for (const DSet& set : sets) largest = std::max(largest, set.members.size());
  EXPECT_EQ(largest, 2u);
}

// Three parallel lines through two leaves, room for two: the two strongest, whole.
TEST(DSets, TheStrongestAreActiveInAllLeavesOrInNone) {
  Face face;
  face.corners = {{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {0, 2, 0}};
  face.plane = viewfactor::plane_of(face.corners);
  const FacePlane plane = plane_coordinates(face);
  std::vector<Discontinuity> all(3);
  for (size_t k = 0; k < 3; ++k) {
    const double y = 0.5 + 0.5 * double(k);
    all[k].a = {0.5, y, 0}, all[k].b = {3.5, y, 0};
  }
  const auto polygon = [&](double x0, double x1) {
    std::vector<DVec2> out;
    for (const DVec3 p : {DVec3{x0, 0, 0}, {x1, 0, 0}, {x1, 2, 0}, {x0, 2, 0}})
      out.push_back(plane.to_plane(p));
    return out;
  };
  const std::vector<std::vector<DVec2>> leaves{polygon(0, 2), polygon(2, 4)};
  const std::vector<double> weight{1, 3, 2};
  const auto active = choose_active(all, weight, 0.5, plane, leaves, 2, 1e-6);
  ASSERT_EQ(active.size(), 2u);
  for (const ActiveLine& line : active) {
    const DVec3 a = plane.from_plane(line.piece.a), b = plane.from_plane(line.piece.b);
    EXPECT_NEAR(std::abs(a.x - b.x), 3, 1e-9);
    EXPECT_GT(a.y, 0.9);
  }
  EXPECT_EQ(choose_active(all, weight, 2.5, plane, leaves, 2, 1e-6).size(), 1u);
}

}  // namespace
}  // namespace luxel::hierarchical
