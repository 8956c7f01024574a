#include "luxel/solve/hierarchical/contacts.h"

#include <cmath>

#include "luxel/solve/hierarchical/hierarchical_test_support.h"

namespace luxel::hierarchical {
namespace {

struct Cut {
  Faces faces;
  std::vector<std::vector<Polygon>> pieces;
};

Cut cut(const scene::Scene& scene) {
  Progress progress;
  Cut out{*make_faces(scene, progress), {}};
  out.pieces = cut_at_contacts(out.faces, make_blockers(out.faces));
  return out;
}

/// A floor of 5 m with a panel on it, 1 m long and 4 cm thick, turned by an angle.
scene::Scene floor_with_panel(float angle) {
  scene::Scene scene;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {-2.5f, 2.5f, -2.5f, 2.5f}, 0, true, gray);
  const float c = std::cos(angle), s = std::sin(angle);
  const auto at = [&](float x, float y, float z) {
    return DVec3{double(c * x - s * z + 0.3f), double(y), double(s * x + c * z - 0.2f)};
  };
  const std::array<std::array<float, 2>, 4> foot{
      {{-0.5f, -0.02f}, {-0.5f, 0.02f}, {0.5f, 0.02f}, {0.5f, -0.02f}}};
  for (size_t k = 0; k < 4; ++k) {
    const auto [x0, z0] = foot[k];
    const auto [x1, z1] = foot[(k + 1) % 4];
    testing::add_polygon(scene, "side",
                         {at(x0, 0, z0), at(x1, 0, z1), at(x1, 0.7f, z1), at(x0, 0.7f, z0)}, gray);
  }
  return scene;
}

/// A place lies under the panel.
bool is_covered(DVec3 p, float angle) {
  const double c = std::cos(double(angle)), s = std::sin(double(angle));
  const double x = p.x - 0.3, z = p.z + 0.2;
  return std::abs(c * x + s * z) < 0.5 && std::abs(c * z - s * x) < 0.02;
}

// The floor under the panel is a piece of its own, and no other piece is as thin as it: cuts that
// follow the panel's long sides end where it ends.
TEST(CutAtContacts, FreesTheFootWithoutStripsFromWallToWall) {
  for (const float angle : {0.0f, 0.7f}) {
    const Cut c = cut(floor_with_panel(angle));
    const uint32_t floor = c.faces.face_of_triangle[0];
    double area = 0, covered = 0;
    for (const Polygon& piece : c.pieces[floor]) {
      const double size = viewfactor::area_m2(piece);
      const DVec3 middle = viewfactor::mean_corner(piece);
      area += size;
      if (is_covered(middle, angle)) {
        covered += size;
        continue;
      }
      for (const DVec3& corner : piece)  // nothing of it is under the panel
        EXPECT_FALSE(is_covered(middle + (corner - middle) * 0.98, angle));
      const double across = size / (2 * viewfactor::radius_about(middle, piece));
      EXPECT_GT(across, 0.4) << "a strip";
    }
    EXPECT_NEAR(area, 25, 1e-5);
    EXPECT_NEAR(covered, 0.04, 1e-6);
    EXPECT_LE(c.pieces[floor].size(), 8u);
  }
}

// A table above the floor touches nothing, and a box as large as the floor leaves it whole.
TEST(CutAtContacts, LeavesWholeWhatNothingStandsOn) {
  scene::Scene scene;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {0, 1, 0, 1}, 0, true, gray);
  scene::Mesh boxes;
  scene::add_box(boxes, {0.2f, 0.01f, 0.2f}, {0.8f, 0.3f, 0.8f}, gray);
  scene::add_box(boxes, {0, 0, 0}, {1, 2, 1}, gray);
  scene::place(scene, std::move(boxes));
  const Cut c = cut(scene);
  EXPECT_EQ(c.pieces[c.faces.face_of_triangle[0]].size(), 1u);
}

}  // namespace
}  // namespace luxel::hierarchical
