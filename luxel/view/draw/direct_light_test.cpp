// Light straight from lamps as a device draws it, pixel by pixel against shadow rays. Skipped
// without a device.
#include "luxel/view/draw/direct_light.h"

#include "luxel/scene/off_surface.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/solve/matrix/live_light.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/view/draw/device_test_support.h"
#include "luxel/view/draw/light_at_points.h"

namespace luxel::view {
namespace {

using Kind = scene::PunctualLight::Kind;

constexpr int kPictureSide = 96;

/// The surface that a ray through the middle of a pixel finds, and its light.
struct Pixel {
  bool is_surface = false;
  Vec3 position, facet;
  uint32_t instance = 0, triangle = 0;
  uint32_t lit = 0;  ///< a bit for each lamp that shines there
  Rgb irradiance;
};

/// E by shadow rays, per pixel.
std::vector<Pixel> by_rays(const scene::Scene& scene, const trace::RayTracer& tracer,
                           const scene::Camera& camera,
                           std::span<const scene::PunctualLight> lamps) {
  std::vector<Pixel> out;
  for (int i = 0; i < kPictureSide * kPictureSide; ++i) {
    std::array rays{trace::CameraRays(camera, kPictureSide, kPictureSide)
                        .through(float(i % kPictureSide) + 0.5f, float(i / kPictureSide) + 0.5f)};
    const trace::Hit hit = trace::visible_hits(scene, tracer, rays).front();
    Pixel& pixel = out.emplace_back();
    if (!hit.found()) continue;
    const scene::SurfacePoint p = hit.point();
    const Vec3 position = scene::world_position(scene, p), normal = scene::shading_normal(scene, p);
    pixel.is_surface = true, pixel.instance = p.instance, pixel.triangle = p.triangle;
    pixel.position = position, pixel.facet = scene::front_normal(scene, p.instance, p.triangle);
    const Vec3 start = scene::off_surface(scene, p, pixel.facet);
    const matrix::LitPoints point{{&start, 1}, {&normal, 1}, {&pixel.facet, 1}};
    for (size_t k = 0; k < lamps.size(); ++k) {
      const Rgb e = matrix::live_light_at(point, 0, {&lamps[k], 1}, tracer);
      if (luminance(e) > 0) pixel.lit |= 1u << k;
      pixel.irradiance += e;
    }
  }
  return out;
}

/// True where all around a pixel is one surface, and nowhere the edge of a shadow. Facets may turn
/// by as much as their normals' cosine says; 1: it is a single triangle.
bool is_within(const std::vector<Pixel>& pixels, int x, int y, int around, float cosine) {
  const Pixel& middle = pixels[size_t(y * kPictureSide + x)];
  for (int v = y - around; v <= y + around; ++v)
    for (int u = x - around; u <= x + around; ++u) {
      if (u < 0 || v < 0 || u >= kPictureSide || v >= kPictureSide) return false;
      const Pixel& p = pixels[size_t(v * kPictureSide + u)];
      if (!p.is_surface || p.instance != middle.instance || p.lit != middle.lit ||
          (cosine < 1 && dot(p.facet, middle.facet) < cosine) ||
          (cosine == 1 && p.triangle != middle.triangle))
        return false;
    }
  return true;
}

/// A pixel and all around it show one triangle.
bool is_one_surface(const std::vector<Pixel>& pixels, int x, int y) {
  return is_within(pixels, x, y, 1, 1);
}

class DirectLightTest : public testing::OnDevice {
 protected:
  /// Puts a scene on the device, without any light.
  void put(const scene::Scene& scene, uint32_t shadow_side) {
    pipeline::LightmapPages black;
    black.pictures.emplace_back(1, 1, 4);
    black.of_material.assign(scene.materials.size(), 0);
    DeviceSceneParams params;
    params.shadow_side = shadow_side;
    auto on_device = put_on_device(*commands_, scene, black, params);
    ASSERT_TRUE(on_device) << on_device.error().message;
    scene_.emplace(std::move(*on_device));
    auto direct = make_direct_light(*device_, *scene_);
    ASSERT_TRUE(direct) << direct.error().message;
    direct_.emplace(std::move(*direct));
  }

  /// E of the lamps per pixel.
  image::Image drawn(const scene::Camera& camera, std::span<const scene::PunctualLight> lamps,
                     const trace::CameraRays* eye = nullptr) {
    EXPECT_TRUE(set_lamps(*device_, lamps, eye, *direct_, *scene_));
    EXPECT_TRUE(commands_->run(
        [&](VkCommandBuffer buffer) { draw_shadow_maps(*device_, buffer, *scene_, *direct_); }));
    const auto painter = make_painter(*device_, *shaders_, *scene_, kPictureSide, kPictureSide);
    EXPECT_TRUE(painter) << painter.error().message;
    Frame frame;
    frame.camera = camera, frame.show = Show::light;
    auto picture = painted_radiance(*commands_, {*shaders_, *painter, *scene_}, frame);
    EXPECT_TRUE(picture) << picture.error().message;
    for (float& value : picture->data) value *= kPi;
    return std::move(*picture);
  }

  void TearDown() override {
    direct_.reset(), scene_.reset();
    OnDevice::TearDown();
  }

  std::optional<DeviceScene> scene_;
  std::optional<DirectLight> direct_;
};

/// Numbers of pixels compared, lit and dark.
struct Compared {
  int lit = 0, dark = 0;
};

/// Compares what lies `around` pixels from every edge. Where single triangles are compared, half a
/// percent is what the device's floats and the halves of its picture make.
Compared expect_alike(const image::Image& drawn, const std::vector<Pixel>& wanted, int around,
                      float cosine = 1) {
  Compared out;
  float most = 0;
  for (const Pixel& p : wanted) most = std::max(most, max_component(p.irradiance));
  int off = 0;
  std::string list;
  for (int y = 0; y < kPictureSide; ++y)
    for (int x = 0; x < kPictureSide; ++x) {
      if (!is_within(wanted, x, y, around, cosine)) continue;
      const Rgb want = wanted[size_t(y * kPictureSide + x)].irradiance, got = drawn.rgb(x, y);
      luminance(want) > 0 ? ++out.lit : ++out.dark;
      const float tolerance = cosine == 1 ? 0.005f : 0.05f;
      if (length(got - want) > tolerance * length(want) + 1e-4f * most && ++off < 10)
        list += fmt::format("({}, {}): {} {} {} for {} {} {}\n", x, y, got.x, got.y, got.z, want.x,
                            want.y, want.z);
    }
  // A facet's own terminator may lie between two pixels.
  EXPECT_LE(off, cosine == 1 ? 0 : (out.lit + out.dark) / 500) << list;
  return out;
}

scene::PunctualLight lamp_of(Kind kind, Vec3 position, Vec3 direction) {
  scene::PunctualLight lamp;
  lamp.kind = kind, lamp.position = position, lamp.direction = normalize(direction);
  lamp.intensity = {1, 0.5f, 0.25f};
  lamp.inner_cone_rad = 0.3f, lamp.outer_cone_rad = 0.6f;
  return lamp;
}

TEST_F(DirectLightTest, LampsShineAndThrowShadowsAsRaysSay) {
  const scene::Scene scene = scene::cornell_box();
  const trace::RayTracer tracer = *trace::RayTracer::build(scene);
  put(scene, 4096);
  const scene::PunctualLight point = lamp_of(Kind::point, {0.1f, 0.45f, 0.3f}, {0, -1, 0});
  const scene::PunctualLight spot = lamp_of(Kind::spot, {0.4f, 0.5f, 0.1f}, {-0.3f, -1, 0.4f});
  scene::PunctualLight wide = lamp_of(Kind::spot, {0.3f, 0.5f, 0.2f}, {0.2f, -1, 0.1f});
  wide.inner_cone_rad = 0, wide.outer_cone_rad = 1.5f;
  scene::PunctualLight near_only = point;
  near_only.range_m = 0.4f;
  const scene::PunctualLight sun = lamp_of(Kind::directional, {}, {0.2f, -0.3f, 1});
  const std::vector<std::vector<scene::PunctualLight>> cases{
      {point}, {spot}, {wide}, {near_only}, {sun}, {point, spot, sun}};
  for (const std::vector<scene::PunctualLight>& lamps : cases) {
    SCOPED_TRACE(&lamps - cases.data());
    const Compared compared = expect_alike(drawn(scene.cameras[0], lamps),
                                           by_rays(scene, tracer, scene.cameras[0], lamps), 3);
    EXPECT_GT(compared.lit, 400);
    if (lamps.size() == 1) {
      EXPECT_GT(compared.dark, 200);
    }
  }
}

// Points get what pixels get, whose shader they share but for the maps and lamps that they are
// given.
TEST_F(DirectLightTest, PointsAreLitAsRaysSay) {
  const scene::Scene scene = scene::cornell_box();
  const trace::RayTracer tracer = *trace::RayTracer::build(scene);
  put(scene, 4096);
  const std::array lamps{lamp_of(Kind::point, {0.1f, 0.45f, 0.3f}, {0, -1, 0}),
                         lamp_of(Kind::spot, {0.4f, 0.5f, 0.1f}, {-0.3f, -1, 0.4f})};
  const std::vector<Pixel> pixels = by_rays(scene, tracer, scene.cameras[0], lamps);
  std::vector<LitPoint> points;
  std::vector<Rgb> wanted;
  for (int i = 0; i < kPictureSide * kPictureSide; ++i)
    if (const Pixel& p = pixels[size_t(i)];
        is_within(pixels, i % kPictureSide, i / kPictureSide, 3, 1))
      points.push_back({p.position, p.facet}), wanted.push_back(p.irradiance);
  ASSERT_GT(points.size(), 1000u);
  const auto at = make_light_at_points(*device_, *scene_, points);
  ASSERT_TRUE(at) << at.error().message;
  ASSERT_TRUE(set_lamps(*device_, lamps, nullptr, *direct_, *scene_));
  ASSERT_TRUE(commands_->run([&](VkCommandBuffer buffer) {
    draw_shadow_maps(*device_, buffer, *scene_, *direct_);
    light_points(*device_, buffer, *scene_, *at);
  }));
  // Both work in floats; no half is between them.
  for (size_t i = 0; i < points.size(); ++i)
    EXPECT_LT(length(at->result()[i] - wanted[i]), 1e-4f * length(wanted[i]) + 1e-6f) << i;
}

// A lamp that goes on is drawn where it is now; one that stands keeps its maps.
TEST_F(DirectLightTest, ShadowsFollowALamp) {
  const scene::Scene scene = scene::cornell_box();
  const trace::RayTracer tracer = *trace::RayTracer::build(scene);
  put(scene, 4096);
  std::array lamps{lamp_of(Kind::point, {0.1f, 0.45f, 0.3f}, {0, -1, 0}),
                   lamp_of(Kind::point, {0.5f, 0.3f, 0.1f}, {0, -1, 0})};
  drawn(scene.cameras[0], lamps);
  const std::vector<ShadowMap> before = direct_->drawn;
  lamps[1].position = {0.45f, 0.5f, 0.2f};
  lamps[0].intensity = {0, 3, 0};
  expect_alike(drawn(scene.cameras[0], lamps), by_rays(scene, tracer, scene.cameras[0], lamps), 3);
  ASSERT_EQ(before.size(), 12u);
  for (size_t k = 0; k < 12; ++k) EXPECT_EQ(before[k] == direct_->drawn[k], k < 6) << k;
  EXPECT_EQ(luminance(drawn(scene.cameras[0], {}).rgb(40, 40)), 0) << "all are off";
}

TEST_F(DirectLightTest, SmoothSurfacesAndMirroredInstances) {
  scene::Scene scene = scene::radiosity_box_with_shapes();
  for (const bool is_mirrored : {false, true}) {
    SCOPED_TRACE(is_mirrored);
    if (is_mirrored)
      for (scene::Instance& instance : scene.instances)
        instance.world_from_object = scaling({-1, 1, 1}) * instance.world_from_object;
    const trace::RayTracer tracer = *trace::RayTracer::build(scene);
    put(scene, 4096);
    const Vec3 middle = scene::world_bounds(scene).centre();
    const std::array lamps{lamp_of(Kind::point, middle + Vec3{0.7f, 0.3f, 0.8f}, {0, -1, 0})};
    // Facets of the shapes are as wide as a few pixels, each with a terminator of its own.
    const Compared compared = expect_alike(
        drawn(scene.cameras[0], lamps), by_rays(scene, tracer, scene.cameras[0], lamps), 2, 0.5f);
    EXPECT_GT(compared.lit, 500);
  }
}

// The sum over a picture: leaves are smaller than what is_within() looks at.
TEST_F(DirectLightTest, HolesOfMasksLetLightThrough) {
  scene::Scene scene = scene::foliage();
  scene.environment = {};
  scene.background = {1e-9f, 1e-9f, 1e-9f};  // black: without one there would be grey
  const std::array lamps{lamp_of(Kind::directional, {}, {0.3f, -1, 0.2f})};
  double light[2] = {};
  for (const bool has_holes : {true, false}) {
    if (!has_holes)
      for (scene::Material& m : scene.materials) m.alpha_mode = scene::AlphaMode::opaque;
    const trace::RayTracer tracer = *trace::RayTracer::build(scene);
    put(scene, 4096);
    const image::Image picture = drawn(scene.cameras[0], lamps);
    double want = 0;
    for (const Pixel& p : by_rays(scene, tracer, scene.cameras[0], lamps))
      want += double(p.irradiance.x);
    for (size_t i = 0; i < picture.data.size(); i += 4) light[has_holes] += double(picture.data[i]);
    EXPECT_NEAR(light[has_holes] / want, 1, 0.04);
  }
  EXPECT_GT(light[1], 1.02 * light[0]);
}

/// A floor of 400 m with posts of 0.4 m, a metre apart, around its middle.
scene::Scene wide_floor() {
  scene::Scene scene;
  scene.materials.emplace_back();
  scene::Mesh mesh;
  const auto quad = [&](Vec3 a, Vec3 u, Vec3 v) {
    const auto first = uint32_t(mesh.positions.size());
    for (const Vec3 p : {a, a + u, a + u + v, a + v}) mesh.positions.push_back(p);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  };
  quad({-200, 0, -200}, {0, 0, 400}, {400, 0, 0});
  for (int i = -3; i <= 3; ++i)
    for (int k = -3; k <= 3; ++k) {
      const Vec3 at{float(i), 0, float(k)};
      const float w = 0.1f, h = 0.4f;
      quad(at + Vec3{0, 0, w}, {w, 0, 0}, {0, h, 0}), quad(at, {0, h, 0}, {w, 0, 0});
      quad(at + Vec3{w, 0, 0}, {0, h, 0}, {0, 0, w}), quad(at, {0, 0, w}, {0, h, 0});
      quad(at + Vec3{0, h, 0}, {0, 0, w}, {w, 0, 0});
    }
  mesh.triangle_material.assign(mesh.triangles.size(), 0);
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({"floor", 0, {}});
  return scene;
}

// One map of all has texels of 0.2 m, in which posts are lost.
TEST_F(DirectLightTest, ShadowsOfASunAreSharpNearTheEye) {
  const scene::Scene scene = wide_floor();
  const trace::RayTracer tracer = *trace::RayTracer::build(scene);
  put(scene, 4096);
  scene::Camera camera;
  camera.world_from_camera = scene::look_at({0, 1.2f, 3}, {0, 0, 0}, {0, 1, 0});
  const std::array lamps{lamp_of(Kind::directional, {}, {0.5f, -1, 0.3f})};
  const std::vector<Pixel> wanted = by_rays(scene, tracer, camera, lamps);
  const trace::CameraRays eye(camera, kPictureSide, kPictureSide);
  const auto wrong = [&](const image::Image& picture) {
    int out = 0;
    for (int i = 10 * kPictureSide; i < kPictureSide * kPictureSide; ++i) {  // below the horizon
      if (!(wanted[size_t(i)].facet.y > 0.5f)) continue;  // edges of posts are narrow
      const float want = wanted[size_t(i)].irradiance.x;
      out += std::abs(picture.data[size_t(4 * i)] - want) > 0.5f * lamps[0].intensity.x;
    }
    return out;
  };
  int dark = 0;
  for (const Pixel& p : wanted) dark += p.is_surface && p.lit == 0;
  EXPECT_GT(dark, 200);
  const int without = wrong(drawn(camera, lamps));
  EXPECT_EQ(direct_->plan.maps.size(), 1u);
  const int with = wrong(drawn(camera, lamps, &eye));
  EXPECT_EQ(direct_->plan.maps.size(), 2u) << "pixels are too wide for more";
  EXPECT_GT(without, 100);
  EXPECT_LT(with, without / 5) << without;
}

// Half of a sun's disc is seen above an edge; the share by 400 rays to all of the disc.
TEST_F(DirectLightTest, EdgesOfShadowsAreAsSoftAsADisc) {
  const scene::Scene scene = scene::cornell_box();
  const trace::RayTracer tracer = *trace::RayTracer::build(scene);
  put(scene, 4096);
  scene::PunctualLight sun = lamp_of(Kind::directional, {}, {0.3f, -0.4f, 1});
  const float radius = 2 * kPi / 180;
  std::vector<double> wanted(kPictureSide * kPictureSide);
  constexpr int kRays = 100;
  const Vec3 aside = normalize(cross(sun.direction, Vec3{0, 1, 0}));
  const Vec3 up = cross(sun.direction, aside);
  std::vector<Pixel> from_centre = by_rays(scene, tracer, scene.cameras[0], {&sun, 1});
  for (Pixel& p : from_centre) p.lit = 0;
  for (int k = 0; k < kRays; ++k) {
    const float r = std::sqrt((float(k) + 0.5f) / kRays) * std::tan(radius);
    const float turn = 2.39996f * float(k);
    scene::PunctualLight part = sun;
    part.direction =
        normalize(sun.direction + aside * (r * std::cos(turn)) + up * (r * std::sin(turn)));
    const std::vector<Pixel> seen = by_rays(scene, tracer, scene.cameras[0], {&part, 1});
    for (size_t i = 0; i < seen.size(); ++i) wanted[i] += double(seen[i].irradiance.x) / kRays;
  }
  const auto off = [&](const image::Image& picture) {
    double sum = 0, light = 0;
    for (size_t i = 0; i < wanted.size(); ++i) {
      if (!is_one_surface(from_centre, int(i) % kPictureSide, int(i) / kPictureSide)) continue;
      const double by = double(picture.data[4 * i]) - wanted[i];
      sum += by * by, light += wanted[i] * wanted[i];
    }
    return std::sqrt(sum / light);
  };
  const double hard = off(drawn(scene.cameras[0], {&sun, 1}));
  sun.angular_radius_rad = radius;
  const double soft = off(drawn(scene.cameras[0], {&sun, 1}));
  EXPECT_LT(soft, 0.5 * hard);
  EXPECT_LT(soft, 0.1);
}

TEST(ShadowMaps, AllLampsFindRoomUntilThereIsNone) {
  Box3 box;
  box.extend({0, 0, 0}), box.extend({2, 1, 3});
  std::vector<scene::PunctualLight> lamps;
  for (int k = 0; k < 200; ++k)
    lamps.push_back(lamp_of(k % 2 ? Kind::point : Kind::directional, {1, 0.5f, 1}, {0, -1, 0.1f}));
  const auto sides = [&](size_t count) {
    const ShadowPlan plan = plan_shadows(std::span(lamps).first(count), box, 4096);
    return std::pair(plan.maps[plan.first_map[0]].side, plan.maps[plan.first_map[1]].side);
  };
  EXPECT_EQ(sides(2), std::pair(2048.0f, 1024.0f));  // 10 of 16 cells
  EXPECT_EQ(sides(12), std::pair(1024.0f, 512.0f));  // 60 of 64
  EXPECT_EQ(sides(14), std::pair(512.0f, 256.0f));
  const ShadowPlan plan = plan_shadows(lamps, box, 1024);
  std::set<std::pair<float, float>> taken;
  for (const ShadowMap& map : plan.maps) {
    EXPECT_TRUE(map.corner.x + map.side <= 1024 && map.corner.y + map.side <= 1024);
    for (float y = 0; y < map.side; y += 64)
      for (float x = 0; x < map.side; x += 64)
        EXPECT_TRUE(taken.insert({map.corner.x + x, map.corner.y + y}).second) << "not shared";
  }
  EXPECT_GT(taken.size(), 250u) << "of 256";
  size_t without = 0;
  for (const uint32_t first : plan.first_map) without += first == scene::kNone;
  EXPECT_GT(without, 0u);
  EXPECT_LT(without, 150u);
}

}  // namespace
}  // namespace luxel::view
