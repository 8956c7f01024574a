// Where triangles are cut: at shadow borders, and nowhere when there is nothing to see.
#include "luxel/solve/hemicube/refine.h"

#include <gtest/gtest.h>

#include "luxel/solve/hemicube/hemicube_test_support.h"

namespace luxel::hemicube {
namespace {

using testing::scene_of;
using testing::solved;

constexpr ElementKind kRefinedKinds[] = {ElementKind::vertex, ElementKind::triangle};

/// A floor of 4 x 4 m, a plate of 1 x 1 m 1 m above its middle, a lamp without size 2 m above it:
/// the shadow is a square of 2 x 2 m with a sharp border.
scene::Scene sharp_shadow() {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, 0);
  scene::add_rectangle(scene, {-0.5f, 0.5f, -0.5f, 0.5f}, 1, true, 0);
  scene::PunctualLight lamp;
  lamp.position = {0, 2, 0};
  scene.lights.push_back(lamp);
  return scene;
}

double distance_to_border(Vec3 p) { return std::abs(std::max(std::abs(p.x), std::abs(p.z)) - 1); }

bool on_floor(const Solution& s, size_t i) {
  return s.field.receivers.kind == ElementKind::vertex
             ? s.field.mesh.vertices[i].instance == 0
             : s.field.mesh.nodes[s.field.receivers.leaves[i]].instance == 0;
}

// Within 5 cm of the border lie 5 % of the floor.
TEST(Refine, PutsElementsAtTheShadowsBorder) {
  const scene::Scene scene = sharp_shadow();
  for (const ElementKind kind : kRefinedKinds) {
    HemicubeParams params;
    params.elements = kind, params.resolution = 8, params.max_elements = 4000;
    const Solution s = solved(scene, params);
    EXPECT_LE(s.field.irradiance.size(), 4000u);
    EXPECT_GT(s.field.irradiance.size(), 3000u);
    double near = 0, all = 0;
    for (size_t i = 0; i < s.field.irradiance.size(); ++i)
      if (on_floor(s, i))
        near += distance_to_border(s.field.receivers.elements.position[i]) < 0.05, ++all;
    EXPECT_GT(near / all, 0.3);
    std::printf("%.1f %% of %g elements on 5 %% of the floor\n", 100 * near / all, all);
  }
}

// Away from the border E of the floor is known: I cos / d^2, or nothing. As much light as in truth
// falls on the floor as a whole, though the border runs through triangles.
TEST(Refine, LightBesideTheBorderIsExact) {
  const scene::Scene scene = sharp_shadow();
  for (const ElementKind kind : kRefinedKinds) {
    HemicubeParams params;
    params.elements = kind, params.resolution = 8, params.max_elements = 4000;
    params.bounces = 0;
    const Solution s = solved(scene, params);
    RandomStream random{1};
    double sum = 0, exact_sum = 0;
    constexpr int kPoints = 20000;
    for (int i = 0; i < kPoints; ++i) {
      const float x = random.next(), y = random.next();
      const scene::SurfacePoint p{0, uint32_t(i % 2), {std::min(x, y), std::abs(x - y)}};
      const Vec3 at = scene::world_position(scene, p);
      const float d2 = at.x * at.x + at.z * at.z + 4;
      const bool dark = std::max(std::abs(at.x), std::abs(at.z)) < 1;
      const float exact = dark ? 0 : 2 / (d2 * std::sqrt(d2));
      const float found = irradiance_at(s.field, p).x;
      sum += double(found), exact_sum += double(exact);
      if (distance_to_border(at) > 0.1) {
        ASSERT_NEAR(found, exact, kind == ElementKind::vertex ? 0.004f : 0.03f)
            << at.x << " " << at.z;
      }
    }
    EXPECT_NEAR(sum / exact_sum, 1, 0.01);
  }
}

/// A floor of rings, each half as wide as the one around it: a cut in the middle wants many others
/// before it, out to the rim.
scene::Mesh ringed_floor() {
  scene::Mesh mesh;
  constexpr int kRings = 9, kSides = 7;
  const auto at = [](int ring, int k) {
    const float a = (float(k) + 0.3f * float(ring % 2)) * 2 * kPi / kSides,
                r = std::ldexp(2.0f, -ring);
    return Vec3{r * std::sin(a), 0, r * std::cos(a)};
  };
  for (int ring = 0; ring + 1 < kRings; ++ring)
    for (int k = 0; k < kSides; ++k)
      scene::add_quad(mesh,
                      {at(ring, k), at(ring, (k + 1) % kSides), at(ring + 1, (k + 1) % kSides),
                       at(ring + 1, k)},
                      0);
  for (int k = 0; k < kSides; ++k)
    scene::add_triangle(mesh, {}, at(kRings - 1, k), at(kRings - 1, (k + 1) % kSides), 0);
  return mesh;
}

TEST(Refine, NeverMakesMoreElementsThanAllowed) {
  scene::Scene scene = sharp_shadow();
  scene.meshes[0] = ringed_floor();
  scene.instances[1].world_from_object = translation({0.5f, 0, 0.2f});
  for (const ElementKind kind : kRefinedKinds)
    for (size_t most = 160; most < 400; most += 7) {
      HemicubeParams params;
      params.elements = kind, params.resolution = 2, params.max_elements = most;
      params.max_error = 1e-4f;
      const Solution s = solved(scene, params);
      EXPECT_LE(s.field.irradiance.size(), most) << int(kind);
      EXPECT_GT(s.field.irradiance.size(), most * 8 / 10) << int(kind);
    }
}

bool was_cut_on(const Solution& s) {
  return s.field.mesh.nodes.size() > s.field.mesh.triangle_count;
}

TEST(Refine, AnErrorOfZeroCutsNothing) {
  const scene::Scene scene = sharp_shadow();
  for (const ElementKind kind : kRefinedKinds) {
    HemicubeParams params;
    params.elements = kind, params.resolution = 4, params.max_elements = 2000;
    params.max_error = 0;
    const Solution s = solved(scene, params);
    EXPECT_FALSE(was_cut_on(s));
    EXPECT_GT(s.field.irradiance.size(), 1000u);  // all of them are in the first mesh
    EXPECT_LE(s.field.irradiance.size(), 2000u);
  }
}

TEST(Refine, ConstantLightIsNotCut) {
  const scene::Scene box = scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1});
  for (const ElementKind kind : kRefinedKinds) {
    HemicubeParams params;
    params.elements = kind, params.resolution = 8, params.max_elements = 1000;
    const Solution s = solved(box, params);
    EXPECT_FALSE(was_cut_on(s));
    EXPECT_LT(s.relative_error, 1e-3);
  }
}

// Light inside of a solid is made up from that around it: its kinks are no reason to cut.
TEST(Refine, SolidsAreNotCutInside) {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, 0);
  scene::Mesh block;
  scene::add_box(block, {-1.03f, 0, -1.03f}, {1.03f, 0.5f, 1.03f}, 0);
  scene::place(scene, std::move(block));
  scene::PunctualLight lamp;
  lamp.position = {1.5f, 1, 0.3f};
  scene.lights.push_back(lamp);
  HemicubeParams params;
  params.resolution = 8, params.max_elements = 2000;
  const Solution s = solved(scene, params);
  EXPECT_TRUE(was_cut_on(s));
  int inside = 0;
  for (const uint32_t leaf : s.field.receivers.leaves) {
    const Node& n = s.field.mesh.nodes[leaf];
    const std::array<Vec3, 3> at{s.field.mesh.points[n.point[0]], s.field.mesh.points[n.point[1]],
                                 s.field.mesh.points[n.point[2]]};
    const Vec3 middle = (at[0] + at[1] + at[2]) / 3;
    // Triangles at the border may be cut together with those outside, and their neighbours with
    // them.
    const float deep = 1.03f - std::max(std::abs(middle.x), std::abs(middle.z));
    if (n.instance != 0 || deep < 1.5f * s.element_size_m) continue;
    ++inside;
    EXPECT_GT(length(cross(at[1] - at[0], at[2] - at[0])),
              0.6f * s.element_size_m * s.element_size_m)
        << middle.x << ' ' << middle.z;
  }
  EXPECT_GT(inside, 20);
}

/// A field over the unit square with light by a function of the place.
template <class Light>
Field field_of(ElementKind kind, float size, const Light& light) {
  const scene::Scene scene = scene_of(testing::unit_square());
  Field field;
  field.mesh = testing::mesh_of(scene, size);
  field.receivers = make_receivers(scene, field.mesh, kind);
  for (size_t i = 0; i < field.receivers.size(); ++i) {
    const Vec3 at = kind == ElementKind::vertex ? field.mesh.points[field.mesh.point_of[i]]
                                                : field.receivers.elements.position[i];
    field.irradiance.push_back(Rgb{1, 1, 1} * light(at));
  }
  return field;
}

// Linear light is interpolated without error. Of constant curvature k the error is k h^2 / 8 in the
// middle of an edge h; the estimate is within a factor of 2 of that.
TEST(InterpolationErrors, AreThoseOfKnownFunctions) {
  for (const float error : interpolation_errors(
           field_of(ElementKind::vertex, 0.1f, [](Vec3 p) { return 1 + 2 * p.x + 3 * p.z; })))
    EXPECT_NEAR(error, 0, 1e-6f);
  const float h = 0.1f, k = 4;
  const Field field = field_of(ElementKind::vertex, h, [&](Vec3 p) { return k / 2 * p.x * p.x; });
  const std::vector<float> errors = interpolation_errors(field);
  const float exact = k * h * h / 8;
  for (size_t i = 0; i < errors.size(); ++i) {
    EXPECT_LT(errors[i], exact * 2 + 1e-6f);
    // A triangle whose side stands at the rim knows nothing of what the light does there.
    const Node& n = field.mesh.nodes[field.receivers.leaves[i]];
    const float x = (field.mesh.points[n.point[0]].x + field.mesh.points[n.point[1]].x +
                     field.mesh.points[n.point[2]].x) /
                    3;
    if (x > 0.4f * h && x < 1 - 0.4f * h) {
      EXPECT_GT(errors[i], exact / 2);
    }
  }
  // Constant over triangles: half the jump to the neighbour. Centroids lie h/3 apart in x or not.
  for (const float error : interpolation_errors(
           field_of(ElementKind::triangle, h, [](Vec3 p) { return 1 + 6 * p.x; }))) {
    EXPECT_GT(error, 6 * h / 3 / 2 * 0.99f);
    EXPECT_LT(error, 6 * h * 2 / 3 / 2 * 1.01f);
  }
}

// Light falls to nothing in one step where a wall stands: no error beside it, where what lies
// beyond is not seen.
TEST(InterpolationErrors, AreNoneBesideWhatIsUnseen) {
  const auto light = [](Vec3 p) { return p.x < 0.51f ? 1 + 2 * p.x : 0; };
  const Field field = field_of(ElementKind::vertex, 0.1f, light);
  std::vector<uint8_t> unseen;
  for (const uint32_t leaf : field.receivers.leaves) {
    const auto& point = field.mesh.nodes[leaf].point;
    unseen.push_back(std::max({field.mesh.points[point[0]].x, field.mesh.points[point[1]].x,
                               field.mesh.points[point[2]].x}) > 0.51f);
  }
  EXPECT_GT(std::ranges::max(interpolation_errors(field)), 0.4f);
  EXPECT_LT(std::ranges::max(interpolation_errors(field, unseen)), 1e-5f);
}

// A wall stands on a floor in triangles with legs of 1/4, its face along a row of vertices. They
// are looked at from 1/40 before it, as at a rim; all others from where they are.
TEST(Receivers, VerticesAtTheFootOfAWallAreLookedAtFromBeforeIt) {
  scene::Scene room = scene_of(testing::unit_square());
  scene::Mesh wall;
  scene::add_box(wall, {0.5f, 0, -0.1f}, {0.6f, 0.5f, 1.1f}, 0);
  scene::place(room, std::move(wall));
  const auto tracer = trace::RayTracer::build(room);
  ASSERT_TRUE(tracer);
  const Mesh mesh = testing::mesh_of(room, 0.25f);
  Receivers receivers = make_receivers(room, mesh, ElementKind::vertex);
  const transport::Elements before = receivers.elements;
  step_off_walls(room, *tracer, mesh, receivers);
  int at_foot = 0;
  for (size_t i = 0; i < receivers.size(); ++i) {
    const Vec3 from = before.position[i], to = receivers.elements.position[i];
    const bool is_foot = mesh.vertices[i].instance == 0 && mesh.points[mesh.point_of[i]].x == 0.5f;
    at_foot += is_foot;
    EXPECT_NEAR(to.x, is_foot ? 0.475f : from.x, 1e-4f) << from.z;
    EXPECT_NEAR(to.y, from.y, 1e-6f);
    EXPECT_NEAR(to.z, from.z, 1e-6f);
  }
  EXPECT_EQ(at_foot, 5);
}

// A square in four triangles about its middle, of which one is cut in two. Their size is the root
// of twice their area: at the two corners that the halves share with a whole one, a tenth of it is,
// by areas of 1/8 and 1/4, 0.1 (0.5 / 8 + sqrt(0.5) / 4) / (1/8 + 1/4); at the others, of two whole
// ones, and on the middle of the side, of two halves, it is that of one. Corners look at the
// middle.
TEST(Receivers, RimsAreLookedAtByTheSizesOfTheirTriangles) {
  const scene::Scene square = testing::scene_of(testing::unit_square());
  Mesh mesh = testing::mesh_of(square, 0);
  Bisector bisector(mesh);
  bisector.cut(0);
  ASSERT_EQ(leaves(mesh).size(), 4u);
  bisector.cut(leaves(mesh)[0]);
  ASSERT_EQ(mesh.vertices.size(), 6u);
  const Receivers receivers = make_receivers(square, mesh, ElementKind::vertex);
  std::vector<double> insets;
  for (size_t i = 0; i < receivers.size(); ++i)
    insets.push_back(
        double(length(receivers.elements.position[i] - mesh.points[mesh.point_of[i]])));
  std::ranges::sort(insets);
  const double whole = 0.1 * std::sqrt(0.5), half = 0.05;
  const double both = (half / 8 + whole / 4) / (1 / 8.0 + 1 / 4.0);
  const std::vector<double> expected{0, half, both, both, whole, whole};
  for (size_t i = 0; i < insets.size(); ++i) EXPECT_NEAR(insets[i], expected[i], 1e-5) << i;
}

}  // namespace
}  // namespace luxel::hemicube
