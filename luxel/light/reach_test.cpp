#include "luxel/light/reach.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/environment.h"
#include "luxel/scene/shapes.h"

namespace luxel::light {
namespace {

/// The ray origin + t d, 0 <= t <= last, meets the box: slabs, in double.
bool ray_meets(Vec3 origin, Vec3 d, double last, const Box3& box) {
  double first = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double o = double(origin[axis]), speed = double(d[axis]);
    const double lower = double(box.lower[axis]), upper = double(box.upper[axis]);
    if (speed == 0) {
      if (o < lower || o > upper) return false;
      continue;
    }
    const double a = (lower - o) / speed, b = (upper - o) / speed;
    first = std::max(first, std::min(a, b)), last = std::min(last, std::max(a, b));
  }
  return first <= last;
}

Vec3 point_in(const Box3& box, RandomStream& random) {
  const Vec3 u{random.next(), random.next(), random.next()};
  return box.lower + u * (box.upper - box.lower);
}

/// Within [-1, 2.3]^3, from points and flat boxes to large ones.
Box3 random_box(RandomStream& random) {
  const auto size = [&] { return std::max(0.0f, 2 * random.next() - 0.7f); };
  const Vec3 lower{2 * random.next() - 1, 2 * random.next() - 1, 2 * random.next() - 1};
  const Vec3 extent{size(), size(), size()};
  return {lower, lower + extent};
}

Box3 grown(const Box3& box, float by) {
  const Vec3 r{by, by, by};
  return {box.lower - r, box.upper + r};
}

bool overlap(const Box3& a, const Box3& b) {
  const Vec3 lower = max(a.lower, b.lower), upper = min(a.upper, b.upper);
  return lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z;
}

/// True: the box that moves from `from` to `to` overlaps `box` at one of many t. `box` is grown by
/// a side's way between two looks, so that nothing is missed where sides move by less than 4 m in
/// all.
bool seen_to_overlap(const Box3& from, const Box3& to, const Box3& box) {
  constexpr int kLooks = 1000;
  const Box3 wide = grown(box, 4.0f / kLooks);
  for (int i = 0; i <= kLooks; ++i) {
    const float t = float(i) / kLooks;
    const Box3 at{from.lower * (1 - t) + to.lower * t, from.upper * (1 - t) + to.upper * t};
    if (overlap(at, wide)) return true;
  }
  return false;
}

TEST(Reach, SegmentsThatMeetTheBoxAreNeverMissed) {
  RandomStream random{7};
  int hits = 0, misses = 0;
  for (int round = 0; round < 3000; ++round) {
    const Box3 from = random_box(random), to = random_box(random), box = random_box(random);
    const bool crosses = may_cross(from, to, box);
    EXPECT_EQ(crosses, may_cross(to, from, box));
    if (crosses) {
      EXPECT_TRUE(seen_to_overlap(from, to, box)) << round;
    }
    bool hit = false;
    for (int i = 0; i < 100 && !hit; ++i) {
      const Vec3 p = point_in(from, random), q = point_in(to, random);
      hit = ray_meets(p, q - p, 1, box);
    }
    if (hit) {
      EXPECT_TRUE(crosses) << round;
    }
    hits += hit, misses += !crosses;
  }
  // Both happen often enough to be tests.
  EXPECT_GT(hits, 200);
  EXPECT_GT(misses, 200);
}

TEST(Reach, SegmentsBesideBehindAndRoundTheCorner) {
  const auto point = [](Vec3 p) { return Box3{p, p}; };
  const Box3 a = point({0, 0, 0}), b = point({4, 4, 0});
  EXPECT_TRUE(may_cross(a, b, {{1, 1, -1}, {2, 2, 1}}));
  EXPECT_TRUE(may_cross(a, b, {{2, 2, 0}, {2, 2, 0}}));
  EXPECT_FALSE(may_cross(a, b, {{1, 1, 0.5f}, {2, 2, 1}}));    // beside
  EXPECT_FALSE(may_cross(a, b, {{5, 5, -1}, {6, 6, 1}}));      // behind the light
  EXPECT_FALSE(may_cross(a, b, {{-2, -2, -1}, {-1, -1, 1}}));  // behind the place
  EXPECT_FALSE(may_cross(a, b, {{3, 0, -1}, {4, 1, 1}}));      // in their box's corner
  EXPECT_TRUE(may_cross(a, grown(b, 3.1f), {{3, 0, -1}, {4, 1, 1}}));
  EXPECT_TRUE(may_cross(a, a, {{-1, -1, -1}, {1, 1, 1}}));
  EXPECT_FALSE(may_cross(a, a, {{1, 1, 1}, {2, 2, 2}}));
  for (const auto& [p, q, r] : {std::tuple{Box3{}, b, a}, {a, Box3{}, a}, {a, b, Box3{}}})
    EXPECT_FALSE(may_cross(p, q, r));  // nothing is there
}

TEST(Reach, RaysOfAConeThatMeetTheBoxAreNeverMissed) {
  RandomStream random{8};
  int hits = 0, misses = 0;
  for (int round = 0; round < 3000; ++round) {
    const Box3 from = random_box(random), box = random_box(random);
    const Frame frame = frame_around(uniform_sphere_sample(random.next2()));
    const float angle = std::array{0.0f, 0.005f, 0.3f, 1.3f}[size_t(round % 4)];
    const bool crosses = may_cross(from, frame.normal, angle, box);
    bool hit = false;
    for (int i = 0; i < 100 && !hit; ++i) {
      const float off = angle * std::sqrt(random.next()), phi = 2 * kPi * random.next();
      const Vec3 d = frame.to_world(
          {std::sin(off) * std::cos(phi), std::sin(off) * std::sin(phi), std::cos(off)});
      hit = ray_meets(point_in(from, random), d, HUGE_VAL, box);
    }
    if (hit) {
      EXPECT_TRUE(crosses) << round;
    }
    hits += hit, misses += !crosses;
  }
  EXPECT_GT(hits, 200);
  EXPECT_GT(misses, 200);
}

// About an axis of space a cone's section is as wide as it is: the tangent.
TEST(Reach, ConesAreAsWideAsTheirAngle) {
  const Box3 from{{1, 1, 1}, {1, 1, 1}};
  const auto reaches = [&](float angle, Vec3 p) {
    return may_cross(from, {0, 1, 0}, angle, {p, p});
  };
  for (const float angle : {0.01f, 0.3f, 1.0f}) {
    const float wide = 5 * std::tan(angle);
    EXPECT_TRUE(reaches(angle, {1 + 0.99f * wide, 6, 1}));
    EXPECT_FALSE(reaches(angle, {1 + 1.01f * wide, 6, 1}));
    EXPECT_TRUE(reaches(angle, {1, 6, 1 - 0.99f * wide}));
    EXPECT_FALSE(reaches(angle, {1, 6, 1 - 1.01f * wide}));
    EXPECT_FALSE(reaches(angle, {1, 0.9f, 1}));  // behind
  }
  EXPECT_TRUE(reaches(0, {1, 6, 1}));
  EXPECT_FALSE(reaches(0, {1.001f, 6, 1}));
}

constexpr Box3 kBox{{-0.5f, 2, -0.5f}, {0.5f, 2.5f, 0.5f}};
constexpr float kLampHeight = 4;

/// A floor of 10 x 10 m.
scene::Scene floor_scene() {
  scene::Scene scene;
  scene::add_material(scene, "floor", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {-5, 5, -5, 5}, 0, true, 0);
  return scene;
}

scene::Scene floor_under(const scene::PunctualLight& lamp) {
  scene::Scene scene = floor_scene();
  scene.lights = {lamp};
  return scene;
}

scene::PunctualLight small_lamp() {
  scene::PunctualLight lamp;
  lamp.position = {0, kLampHeight, 0};
  return lamp;
}

/// 80 x 80 places on the floor, 10 cm apart, from -3.95 m on.
transport::Elements floor_elements() {
  transport::Elements out;
  for (int i = 0; i < 80 * 80; ++i)
    out.position.push_back({0.1f * float(i % 80) - 3.95f, 0, 0.1f * float(i / 80) - 3.95f});
  out.normal = out.geometric_normal = MappedVector<Vec3>(out.size(), {0, 1, 0});
  out.reflectance.resize(out.size());
  return out;
}

std::vector<uint8_t> reach_of(const scene::Scene& scene, float radius_m,
                              std::span<const Box3> boxes = std::span(&kBox, 1)) {
  const transport::Elements elements = floor_elements();
  const std::vector<float> radius(elements.size(), radius_m);
  return elements_in_reach(scene, elements, radius, collect_lights(scene), boxes);
}

/// That exactly the square |x|, |z| <= half of the floor is in reach. Places up to 3 mm from its
/// edge may be either: boxes grow by 2^-15 of 5 m, or 20 m with a far light, which the lamp
/// enlarges by less than 4.
void expect_square(const std::vector<uint8_t>& reach, float half) {
  const transport::Elements elements = floor_elements();
  ASSERT_EQ(reach.size(), elements.size());
  for (size_t i = 0; i < reach.size(); ++i) {
    const Vec3 p = elements.position[i];
    const float off = std::max(std::abs(p.x), std::abs(p.z));
    if (std::abs(off - half) > 3e-3f) {
      ASSERT_EQ(reach[i], off < half) << p.x << " " << p.z;
    }
  }
}

int count(const std::vector<uint8_t>& reach) {
  return std::accumulate(reach.begin(), reach.end(), 0);
}

// The shadow is that of the box's top, which is nearest to the lamp. From a height of -r it is
// larger, and all within r of it counts.
TEST(ElementsInReach, AreTheShadowOfABoxUnderALamp) {
  for (const float radius : {0.0f, 0.1f, 0.43f})
    expect_square(reach_of(floor_under(small_lamp()), radius),
                  0.5f * (kLampHeight + radius) / (kLampHeight - 2.5f) + radius);
  // Two boxes, of which one is empty.
  const std::vector<Box3> boxes{Box3{}, kBox};
  expect_square(reach_of(floor_under(small_lamp()), 0, boxes), 4.0f / 3);
}

TEST(ElementsInReach, AreNoneWithoutABoxOrLight) {
  EXPECT_EQ(count(reach_of(floor_under(small_lamp()), 0.1f, {})), 0);
  EXPECT_EQ(count(reach_of(floor_scene(), 0.1f)), 0);
  scene::PunctualLight black = small_lamp();
  black.intensity = {};
  EXPECT_EQ(count(reach_of(floor_under(black), 0.1f)), 0);
  // Light that rays find by themselves, from all around.
  scene::Scene sky = floor_scene();
  sky.background = {1, 1, 1};
  sky.environment = {2, 1, {{1, 1, 1}, {1, 1, 1}}, 0};
  EXPECT_EQ(count(reach_of(sky, 0.1f)), 0);
}

TEST(ElementsInReach, EndWhereTheLampDoes) {
  scene::PunctualLight lamp = small_lamp();
  lamp.range_m = 4.1f;
  const transport::Elements elements = floor_elements();
  const auto reach = reach_of(floor_under(lamp), 0);
  for (size_t i = 0; i < reach.size(); ++i) {
    const Vec3 p = elements.position[i];
    const bool shadow = std::max(std::abs(p.x), std::abs(p.z)) < 4.0f / 3;
    const float distance = length(lamp.position - p);
    // No place is nearer to the end than that.
    if (std::abs(distance - lamp.range_m) > 1e-4f) {
      ASSERT_EQ(reach[i], shadow && distance < lamp.range_m) << p.x << " " << p.z;
    }
  }
}

// The edge of the penumbra: from the far edge of the light past the near edge of the box. A second
// light makes a group with it, and sends the box's shadow beyond the floor.
TEST(ElementsInReach, AreThePenumbraUnderAnEmissiveTriangle) {
  constexpr float a = 0.1f;
  for (const bool second : {false, true}) {
    scene::Scene scene = floor_scene();
    const uint32_t glow = scene::add_material(scene, "glow", {}, {1, 1, 1});
    scene::add_rectangle(scene, {-a, a, -a, a}, kLampHeight, false, glow);
    if (second) scene::add_rectangle(scene, {20 - a, 20 + a, -a, a}, kLampHeight, false, glow);
    expect_square(reach_of(scene, 0), -a + (0.5f + a) * kLampHeight / (kLampHeight - 2.5f));
  }
}

TEST(ElementsInReach, AreThePenumbraUnderOneTriangle) {
  constexpr float a = 0.1f;
  scene::Scene scene = floor_scene();
  scene::Mesh mesh;
  const uint32_t glow = scene::add_material(scene, "glow", {}, {1, 1, 1});
  scene::add_triangle(mesh, {-a, kLampHeight, -a}, {a, kLampHeight, a}, {-a, kLampHeight, a}, glow);
  scene::place(scene, mesh);
  // It counts as the square around it.
  expect_square(reach_of(scene, 0), -a + (0.5f + a) * kLampHeight / (kLampHeight - 2.5f));
}

TEST(ElementsInReach, AreTheShadowInTheSun) {
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.direction = {0, -1, 0};
  expect_square(reach_of(floor_under(sun), 0), 0.5f);
  sun.angular_radius_rad = 0.1f;
  // The cone counts as a pyramid, its base as high as the box's top.
  expect_square(reach_of(floor_under(sun), 0), 0.5f + 2.5f * std::tan(0.1f));
  // At 45 degrees from -x the shadow lies at +x, from the lower edge's to the upper edge's.
  sun.angular_radius_rad = 0, sun.direction = normalize(Vec3{1, -1, 0});
  const transport::Elements elements = floor_elements();
  const auto reach = reach_of(floor_under(sun), 0);
  for (size_t i = 0; i < reach.size(); ++i) {
    const Vec3 p = elements.position[i];
    ASSERT_EQ(reach[i], p.x > 1.5f && p.x < 3 && std::abs(p.z) < 0.5f) << p.x << " " << p.z;
  }
}

scene::Scene floor_under_sky(std::initializer_list<size_t> suns) {
  scene::Scene scene = floor_scene();
  scene.environment = {64, 32, std::vector<Rgb>(64 * 32, {0.1f, 0.1f, 0.1f}), 0.7f};
  for (const size_t pixel : suns) scene.environment.radiance[pixel] = {9000, 9000, 9000};
  return scene;
}

TEST(ElementsInReach, AreTheShadowUnderBrightTexelsOfASky) {
  const scene::Scene scene = floor_under_sky({6 * 64 + 20, 6 * 64 + 21, 7 * 64 + 20});
  const Lights lights = collect_lights(scene);
  ASSERT_EQ(lights.around.bright_texels.size(), 3u);
  const transport::Elements elements = floor_elements();
  const auto reach = reach_of(scene, 0);
  for (size_t i = 0; i < reach.size(); ++i)
    for (uint32_t k = 0; k < 64; ++k) {
      const Vec3 d = sample_bright_texels(scene, lights.around, sobol_owen_2d(k, 5)).direction;
      if (ray_meets(elements.position[i], d, HUGE_VAL, kBox)) {
        ASSERT_EQ(reach[i], 1) << i;
      }
    }
  // The true shadow is some 3 square metres, which the cone's width of 0.2 at 3 m makes twice that.
  EXPECT_GT(count(reach), 150);
  EXPECT_LT(count(reach), 1200);
  // Towards the suns nothing stands before the box.
  const Vec3 d = scene::direction_of(scene.environment, {20.5f / 64, 6.5f / 32});
  for (size_t i = 0; i < reach.size(); ++i)
    if (dot(elements.position[i], Vec3{d.x, 0, d.z}) > 0.5f) {
      ASSERT_EQ(reach[i], 0);
    }
}

TEST(ElementsInReach, AreAllWhereBrightTexelsAreAllAround) {
  const std::vector<uint8_t> all(80 * 80, 1);
  EXPECT_EQ(reach_of(floor_under_sky({15 * 64 + 3, 15 * 64 + 35}), 0), all);
  EXPECT_EQ(reach_of(floor_under_sky({12 * 64 + 3, 12 * 64 + 35}), 0, {}),
            std::vector<uint8_t>(80 * 80, 0));
}

}  // namespace
}  // namespace luxel::light
