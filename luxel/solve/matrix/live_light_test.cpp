#include "luxel/solve/matrix/live_light.h"

#include <gtest/gtest.h>

#include "luxel/base/parallel.h"
#include "luxel/scene/off_surface.h"
#include "luxel/solve/matrix/matrix_test_support.h"

namespace luxel::matrix {
namespace {

using testing::Cut;
using testing::plate;
using Kind = scene::PunctualLight::Kind;

/// Light takes a dozen operations on floats.
constexpr double kRounding = 2e-6;

struct LiveStage {
  scene::Scene scene;
  trace::RayTracer tracer;

  explicit LiveStage(scene::Scene s)
      : scene(std::move(s)), tracer(*trace::RayTracer::build(scene)) {}
};

/// Places that lamps shine on.
struct Ground {
  std::vector<Vec3> position, normal, geometric_normal;

  void add(Vec3 p, Vec3 n) {
    position.push_back(p), normal.push_back(n), geometric_normal.push_back(n);
  }
  LitPoints places() const { return {position, normal, geometric_normal}; }
};

/// 16 x 16 places of the square [0, 1]^2 at y = 0.
Ground plate_places() {
  Ground out;
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 16; ++i)
      out.add(scene::off_surface({(float(i) + 0.5f) / 16, 0, (float(j) + 0.5f) / 16}, {0, 1, 0}, 0),
              {0, 1, 0});
  return out;
}

std::vector<Rgb> light(const LiveStage& stage, const Ground& ground,
                       const std::vector<scene::PunctualLight>& lamps) {
  std::vector<Rgb> out(ground.position.size(), {7, 7, 7});  // what was there is forgotten
  live_light(ground.places(), lamps, stage.tracer, out);
  return out;
}

scene::PunctualLight live_point_at(Vec3 position, Rgb intensity = {3, 2, 1}) {
  scene::PunctualLight lamp;
  lamp.position = position, lamp.intensity = intensity;
  return lamp;
}
scene::PunctualLight sun_along(Vec3 direction) {
  scene::PunctualLight lamp;
  lamp.kind = Kind::directional, lamp.direction = normalize(direction), lamp.intensity = {3, 2, 1};
  return lamp;
}

/// `share` of the lamp's intensity on a facing surface, in each channel.
void expect_share(Rgb got, double share, const scene::PunctualLight& lamp, size_t place) {
  for (int c = 0; c < 3; ++c) {
    const double want = share * double(lamp.intensity[c]);
    EXPECT_NEAR(double(got[c]), want, kRounding * want) << "place " << place << ", " << c;
  }
}

double squared(Vec3 v) {
  return double(v.x) * double(v.x) + double(v.y) * double(v.y) + double(v.z) * double(v.z);
}

TEST(LiveLight, OfAPointIsTheInverseSquareTimesTheCosine) {
  const Ground ground = plate_places();
  const auto lamp = live_point_at({0.3f, 0.8f, 0.6f});
  const std::vector<Rgb> e = light(LiveStage(plate()), ground, {lamp});
  for (size_t i = 0; i < e.size(); ++i) {
    const double d2 = squared(lamp.position - ground.position[i]);
    const auto height = double(lamp.position.y - ground.position[i].y);
    expect_share(e[i], height / std::sqrt(d2) / d2, lamp, i);
  }
}

TEST(LiveLight, EndsAtItsRange) {
  // glTF's window, 1 - (d / range)^4 [KHR_lights_punctual]. The range ends within the plate.
  const Ground ground = plate_places();
  auto lamp = live_point_at({0.5f, 0.25f, 0.5f});
  lamp.range_m = 0.5f;
  const std::vector<Rgb> e = light(LiveStage(plate()), ground, {lamp});
  size_t dark = 0;
  for (size_t i = 0; i < e.size(); ++i) {
    const double d2 = squared(lamp.position - ground.position[i]);
    const double window = std::max(0.0, 1 - d2 * d2 / 0.0625);
    dark += window == 0;
    // The window is the difference of numbers near 1.
    const double want = window * 0.25 / std::sqrt(d2) / d2 * double(lamp.intensity.x);
    EXPECT_NEAR(double(e[i].x), want, kRounding * (want + 0.25 / std::sqrt(d2) / d2 * 3)) << i;
  }
  EXPECT_GT(dark, 20u);
  EXPECT_LT(dark, 236u);
}

TEST(LiveLight, OfASpotStaysInItsCone) {
  // ((cos a - cos outer) / (cos inner - cos outer))^2 between the cones [KHR_lights_punctual].
  const Ground ground = plate_places();
  auto lamp = live_point_at({0.5f, 1, 0.5f});
  lamp.kind = Kind::spot, lamp.inner_cone_rad = 0.2f, lamp.outer_cone_rad = 0.4f;
  const std::vector<Rgb> e = light(LiveStage(plate()), ground, {lamp});
  std::array<int, 3> met{};
  for (size_t i = 0; i < e.size(); ++i) {
    const double d2 = squared(lamp.position - ground.position[i]);
    const double cosine = double(lamp.position.y - ground.position[i].y) / std::sqrt(d2);
    const double edge = (cosine - std::cos(0.4)) / (std::cos(0.2) - std::cos(0.4));
    const double t = std::clamp(edge, 0.0, 1.0);
    ++met[t == 0 ? 0 : t == 1 ? 2 : 1];
    const double whole = cosine / d2 * double(lamp.intensity.x);
    // cos inner - cos outer is 0.059, so rounding of 6e-8 counts 34 times in the square of t.
    EXPECT_NEAR(double(e[i].x), t * t * whole, 5e-6 * whole) << i;
    if (t == 0) {
      EXPECT_EQ(e[i], Rgb{}) << i;
    }
  }
  for (const int count : met) EXPECT_GT(count, 10);
}

TEST(LiveLight, OfASunIsItsCosine) {
  const Ground ground = plate_places();
  for (const Vec3 direction : {Vec3{0, -1, 0}, Vec3{3, -4, 0}, Vec3{2, -1, -2}}) {
    const auto sun = sun_along(direction);
    const std::vector<Rgb> e = light(LiveStage(plate()), ground, {sun});
    const double cosine = double(-direction.y) / std::sqrt(squared(direction));
    for (size_t i = 0; i < e.size(); ++i) expect_share(e[i], cosine, sun, i);
  }
}

TEST(LiveLight, NothingArrivesFromBehind) {
  const LiveStage stage(plate());
  const Ground ground = plate_places();
  for (const auto& lamp :
       {live_point_at({0.5f, -1, 0.5f}), live_point_at({2, 0, 0.5f}), sun_along({0, 1, 0})})
    for (const Rgb& e : light(stage, ground, {lamp})) EXPECT_EQ(e, Rgb{});
  // Beneath a bent normal: what is behind the surface itself, and what is behind the normal.
  Ground bent = ground;
  std::fill(bent.normal.begin(), bent.normal.end(), Vec3{0.8f, 0.6f, 0});
  for (const auto& sun : {sun_along({-4, 1, 0}), sun_along({4, -1, 0})})
    for (const Rgb& e : light(stage, bent, {sun})) EXPECT_EQ(e, Rgb{});
  // Above both, the cosine is the bent normal's: (0.8, 0.6) . (0.6, 0.8) = 0.96.
  const auto sun = sun_along({-3, -4, 0});
  const std::vector<Rgb> e = light(stage, bent, {sun});
  for (size_t i = 0; i < e.size(); ++i) expect_share(e[i], 0.96, sun, i);
}

TEST(LiveLight, CastsTheShadowThatLinesSay) {
  scene::Scene scene = plate();
  scene::add_rectangle(scene, {0.375f, 0.5f, -1, 2}, 0.5f, true, 0);
  const LiveStage stage(std::move(scene));
  const Ground ground = plate_places();
  // From x = 0.25, twice as high as the blocker, its shadow is [0.5, 0.75]; the sun's is as wide as
  // itself. No place lies on their edges.
  const auto lamp = live_point_at({0.25f, 1, 0.5f});
  const std::vector<Rgb> of_lamp = light(stage, ground, {lamp});
  const std::vector<Rgb> of_sun = light(stage, ground, {sun_along({0, -1, 0})});
  for (size_t i = 0; i < ground.position.size(); ++i) {
    const float x = ground.position[i].x;
    EXPECT_EQ(of_lamp[i] == Rgb{}, x > 0.5f && x < 0.75f) << i;
    EXPECT_EQ(of_sun[i] == Rgb{}, x > 0.375f && x < 0.5f) << i;
  }
}

TEST(LiveLight, ALampThatTouchesAWallIsNotHiddenByIt) {
  // Nothing is in the way inside a convex solid, wherever on its 320 faces lamp and place are.
  const LiveStage stage(scene::inward_sphere(1, 2, {0.5f, 0.5f, 0.5f}, {}));
  Ground ground;
  for (uint32_t t = 0; t < stage.scene.meshes[0].triangles.size(); ++t) {
    const Vec3 n = scene::front_normal(stage.scene, 0, t);
    ground.add(scene::off_surface(stage.scene, {0, t, {1.0f / 3, 1.0f / 3}}, n), n);
  }
  for (size_t from = 0; from < ground.position.size(); from += 7) {
    const auto lamp = live_point_at(ground.position[from]);
    const std::vector<Rgb> e = light(stage, ground, {lamp});
    for (size_t i = 0; i < e.size(); ++i) {
      if (i == from) continue;
      const Vec3 to = lamp.position - ground.position[i];
      const double d2 = squared(to), along = double(dot(ground.normal[i], to));
      const double want = along / (d2 * std::sqrt(d2)) * double(lamp.intensity.x);
      // Neighbours see the lamp at a low angle: `along` is a small difference of numbers near 1.
      EXPECT_NEAR(double(e[i].x), want, kRounding * (want + 3 / (d2 * std::sqrt(d2)))) << i;
      EXPECT_GT(e[i].x, 0) << from << " to " << i;
    }
  }
}

TEST(LiveLight, ALampAHairAboveTheCeilingIsSeen) {
  const Ground ground = plate_places();
  for (const float above : {0.0f, 1e-6f, 1e-5f}) {
    scene::Scene scene = plate();
    scene::add_rectangle(scene, {-9, 9, -9, 9}, 1, false, 0);
    const auto lamp = live_point_at({0.5f, 1 + above, 0.5f});
    const std::vector<Rgb> e = light(LiveStage(std::move(scene)), ground, {lamp});
    for (size_t i = 0; i < e.size(); ++i) {
      const double d2 = squared(lamp.position - ground.position[i]);
      expect_share(e[i], double(lamp.position.y) / (d2 * std::sqrt(d2)), lamp, i);
    }
  }
}

TEST(LiveLight, ALampBehindAWallIsHidden) {
  scene::Scene scene = plate();
  scene::add_rectangle(scene, {-9, 9, -9, 9}, 1, false, 0);
  const LiveStage stage(std::move(scene));
  for (const Rgb& e : light(stage, plate_places(), {live_point_at({0.5f, 1.001f, 0.5f})}))
    EXPECT_EQ(e, Rgb{});
  for (const Rgb& e : light(stage, plate_places(), {live_point_at({0.5f, 0.999f, 0.5f})}))
    EXPECT_GT(e.x, 0);
}

TEST(LiveLight, WithoutLampsIsDark) {
  for (const Rgb& e : light(LiveStage(plate()), plate_places(), {})) EXPECT_EQ(e, Rgb{});
}

/// The Cornell box, all over, and lamps of every kind.
struct LitRoom {
  Cut cut{scene::cornell_box(), 300};
  Ground ground;
  std::vector<scene::PunctualLight> lamps{live_point_at({0.2f, 0.4f, 0.1f}),
                                          live_point_at({0.5f, 0.5f, 0.5f}),
                                          sun_along({0.3f, -0.2f, 1})};
  LitRoom() {
    for (const PatchPoint& p : cut.patches().points) ground.add(p.position, p.normal);
    lamps[1].kind = Kind::spot, lamps[1].direction = normalize(Vec3{-1, -1, -1});
  }
  std::vector<Rgb> light() const {
    std::vector<Rgb> out(ground.position.size());
    live_light(ground.places(), lamps, cut.tracer, out);
    return out;
  }
};

TEST(LiveLight, OfOnePlaceIsThatOfAll) {
  const LitRoom room;
  const std::vector<Rgb> e = room.light();
  size_t lit = 0;
  for (size_t i = 0; i < e.size(); ++i) {
    EXPECT_EQ(live_light_at(room.ground.places(), i, room.lamps, room.cut.tracer), e[i]) << i;
    lit += max_component(e[i]) > 0;
  }
  EXPECT_GT(lit, e.size() / 4);
  EXPECT_LT(lit, e.size());
}

TEST(LiveLight, SameBitsForAnyNumberOfThreads) {
  const LitRoom room;
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return room.light();
  };
  const std::vector<Rgb> one = with(1);
  EXPECT_EQ(one, with(2));
  EXPECT_EQ(one, with(7));
}

}  // namespace
}  // namespace luxel::matrix
