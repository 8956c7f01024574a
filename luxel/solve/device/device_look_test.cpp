// Hemicubes on a device see what those of the processor see. Skipped without a device.
#include "luxel/solve/device/device_look.h"

#include <gmock/gmock.h>

#include "luxel/base/differences.h"
#include "luxel/gpu/device_test_support.h"
#include "luxel/scene/sides.h"
#include "luxel/scene/surface_points.h"
#include "luxel/solve/hemicube/hemicube_test_support.h"
#include "luxel/viewfactor/point_form_factor.h"

namespace luxel::device {
namespace {

using hemicube::ElementKind;

struct Seen {
  std::vector<std::vector<float>> share;  ///< per viewpoint and element
  std::vector<hemicube::View> view;
};

class HemicubesOnDevice : public gpu::testing::OnDevice {
 protected:
  /// The views of all elements of a mesh. `on` null: on the processor.
  Seen look(const scene::Scene& scene, const hemicube::Mesh& mesh, ElementKind kind,
            hemicube::LookDevice* on) const {
    const auto tracer = trace::RayTracer::build(scene);
    EXPECT_TRUE(tracer);
    if (on) {
      EXPECT_TRUE(on->begin(scene));
    }
    const hemicube::Receivers receivers = make_receivers(scene, mesh, kind);
    const light::Surroundings around = light::surroundings_of(scene);
    const size_t n = receivers.size();
    Seen out{std::vector(n, std::vector<float>(n)), std::vector<hemicube::View>(n)};
    Progress progress;
    const auto done = [&](size_t i, const hemicube::View& view) -> Status {
      out.view[i] = view;
      for (size_t k = 0; k < view.element.size(); ++k)
        out.share[i][view.element[k]] = view.share[k];
      return {};
    };
    const auto seconds = hemicube::look({scene, *tracer, mesh, receivers, around, true},
                                        hemicube::viewpoints(receivers.elements),
                                        {.resolution = 32, .device = on}, done, progress);
    EXPECT_TRUE(seconds) << seconds.error().message;
    return out;
  }
  void expect_the_same(const scene::Scene& scene, const hemicube::Mesh& mesh, ElementKind kind);

  void SetUp() override {
    OnDevice::SetUp();
    if (device_) device_look_ = look_device(*device_);
  }

  std::unique_ptr<hemicube::LookDevice> device_look_;
};

void HemicubesOnDevice::expect_the_same(const scene::Scene& scene, const hemicube::Mesh& mesh,
                                        ElementKind kind) {
  const Seen expected = look(scene, mesh, kind, nullptr),
             found = look(scene, mesh, kind, device_look_.get());
  double difference = 0;
  for (size_t i = 0; i < expected.view.size(); ++i) {
    for (size_t k = 0; k < expected.share[i].size(); ++k)
      difference += double(std::abs(found.share[i][k] - expected.share[i][k]));
    const hemicube::View &f = found.view[i], &e = expected.view[i];
    // One pixel that grazes an edge, of 3,072.
    EXPECT_NEAR(f.back, e.back, 1e-3f);
    EXPECT_NEAR(f.two_sided_back, e.two_sided_back, 1e-3f);
    EXPECT_LE(length(f.emitted - e.emitted), 2e-3f * (1 + length(e.emitted)));
  }
  // In the mean, one pixel of an element's thousands.
  EXPECT_LT(difference / double(expected.view.size()), 4e-4);
}

/// A room under a bright and a dark half of the sky: a floor, a wall, and a double-sided leaf.
scene::Scene leaf_under_a_sky(bool has_both_sides) {
  scene::Scene scene;
  scene.environment.width = 8, scene.environment.height = 4;
  for (int k = 0; k < 32; ++k)
    scene.environment.radiance.push_back(k % 8 < 4 ? Rgb{0.2f, 0.1f, 0.1f} : Rgb{1, 0.8f, 0.5f});
  const uint32_t gray = scene::add_material(scene, "gray", {0.8f, 0.8f, 0.8f}, {});
  const uint32_t leaf = scene::add_material(scene, "leaf", {0.6f, 0.7f, 0.2f}, {2, 1, 0.5f});
  scene.materials[leaf].double_sided = true;
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 0, true, gray);
  scene::add_rectangle(scene, {-0.5f, 0.5f, -0.5f, 0.5f}, 0.4f, true, leaf);
  scene::add_rectangle(scene, {-0.2f, 0.2f, 0.6f, 0.9f}, 0.3f, true, gray);
  if (has_both_sides) scene::add_backs(scene, scene.instances[1].mesh, std::vector<uint8_t>{1, 1});
  return scene;
}

// Vertices and triangles, cut and not, in a closed room and under a sky, with lights that pixels
// see and with the backs of surfaces.
TEST_F(HemicubesOnDevice, SeeWhatTheProcessorSees) {
  const scene::Scene box = scene::cornell_box();
  hemicube::Mesh cut = hemicube::testing::mesh_of(box, 0.2f);
  hemicube::testing::cut_at_random(cut, 60, 4);
  expect_the_same(box, cut, ElementKind::vertex);
  expect_the_same(box, cut, ElementKind::triangle);
  for (const bool has_both_sides : {false, true}) {
    const scene::Scene leaf = leaf_under_a_sky(has_both_sides);
    expect_the_same(leaf, hemicube::testing::mesh_of(leaf, 0.3f), ElementKind::vertex);
  }
}

// The factors from the middle of a cube's floor to its five other sides, in closed form. Only
// pixels on an outline err: a share of about 1 / 32 of them, of either sign.
TEST_F(HemicubesOnDevice, HaveTheFactorsOfACube) {
  scene::Scene scene = hemicube::testing::scene_of(hemicube::testing::unit_cube());
  for (scene::Mesh& mesh : scene.meshes)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);  // seen from inside
  const hemicube::Mesh mesh = hemicube::testing::mesh_of(scene);
  const hemicube::Receivers receivers = make_receivers(scene, mesh, ElementKind::triangle);
  const auto tracer = trace::RayTracer::build(scene);
  ASSERT_TRUE(tracer);
  const hemicube::Viewpoint middle{{0.5f, 1e-6f, 0.5f}, {0, 1, 0}, {0, 1, 0}};
  const light::Surroundings around = light::surroundings_of(scene);
  std::vector<float> share(receivers.size());
  Progress progress;
  ASSERT_TRUE(device_look_->begin(scene));
  ASSERT_TRUE(device_look_->look(
      {scene, *tracer, mesh, receivers, around, false}, {&middle, 1}, {.resolution = 64},
      [&](size_t, const hemicube::View& view) -> Status {
        for (size_t k = 0; k < view.element.size(); ++k) share[view.element[k]] = view.share[k];
        return {};
      },
      progress));
  double sum = 0;
  for (uint32_t k = 0; k < receivers.size(); ++k) {
    const auto& point = mesh.nodes[receivers.leaves[k]].point;
    const std::array<Vec3, 3> corners{mesh.points[point[0]], mesh.points[point[1]],
                                      mesh.points[point[2]]};
    const double exact = viewfactor::point_to_polygon(middle.position, middle.normal, corners);
    EXPECT_NEAR(double(share[k]), exact, 2e-3) << k;
    sum += double(share[k]);
  }
  EXPECT_NEAR(sum, 1, 1e-5);
}

// With cuts where light varies, and all bounces.
TEST_F(HemicubesOnDevice, SolveTheSame) {
  const scene::Scene box = scene::cornell_box();
  const auto tracer = trace::RayTracer::build(box);
  ASSERT_TRUE(tracer);
  const light::Lights lights = light::collect_lights(box);
  hemicube::HemicubeParams params{
      .resolution = 32, .element_size_m = 0.15f, .max_elements = 900, .direct_samples = 64};
  Progress progress;
  const auto expected = hemicube::solve(box, lights, *tracer, params, progress);
  params.device = device_look_.get();
  const auto found = hemicube::solve(box, lights, *tracer, params, progress);
  ASSERT_TRUE(expected && found);
  ASSERT_EQ(found->field.receivers.size(), expected->field.receivers.size());
  // Place by place: cuts of nearly the same worth may be numbered in another order.
  std::vector<float> f, e;
  for (const scene::SurfacePoint& p : scene::points_uniform_in_area(box, 4096, 1)) {
    f.push_back(luminance(hemicube::irradiance_at(found->field, p)));
    e.push_back(luminance(hemicube::irradiance_at(expected->field, p)));
  }
  const Differences d = differences(f, e);
  EXPECT_LT(d.rms, 2e-3);
  EXPECT_LT(std::abs(d.bias), 2e-4);
}

// A leaf that glows in the colours of a picture, with texels of its own on both sides or not; and
// one whose mesh has no coordinates, which glows as its material says.
TEST_F(HemicubesOnDevice, SeePicturesThatShine) {
  for (const bool has_both_sides : {false, true})
    for (const bool has_coordinates : {false, true}) {
      scene::Scene scene = leaf_under_a_sky(false);
      scene::Texture& texture = scene.textures.emplace_back();
      texture.width = 4, texture.height = 3;
      for (int k = 0; k < 12; ++k)
        for (const int c : {k * 20, 255 - k * 17, k % 2 * 200, 255})
          texture.rgba.push_back(uint8_t(c));
      scene.materials[1].emission_texture.texture = 0;
      scene::Mesh& leaf = scene.meshes[scene.instances[1].mesh];
      if (has_coordinates)
        for (const Vec3& p : leaf.positions) leaf.uv0.push_back({2 * p.x, p.z + 0.3f * p.x});
      if (has_both_sides)
        scene::add_backs(scene, scene.instances[1].mesh, std::vector<uint8_t>{1, 1});
      expect_the_same(scene, hemicube::testing::mesh_of(scene, 0.3f), ElementKind::vertex);
    }
}

}  // namespace
}  // namespace luxel::device
