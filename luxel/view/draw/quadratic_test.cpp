// Quadratic light on a device against the processor's.
#include <cmath>
#include <numbers>

#include "luxel/base/random.h"
#include "luxel/scene/procedural.h"
#include "luxel/view/draw/device_test_support.h"

namespace luxel::view {
namespace {

constexpr int kLitWidth = 64, kLitHeight = 48;

/// The Cornell box with quadratic light of no meaning on its triangles.
display::QuadraticMesh some_light(const scene::Scene& scene) {
  display::QuadraticMesh out;
  uint64_t seed = 1;
  const auto number = [&] { return float(hash64(seed++, 7) % 1000) / 1000; };
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[instance.mesh];
    for (const auto& corners : mesh.triangles) {
      const auto first = uint32_t(out.vertices.size());
      for (const uint32_t v : corners)
        out.vertices.push_back(transform_point(instance.world_from_object, mesh.positions[v]));
      out.triangles.push_back({first, first + 1, first + 2});
      auto& r = out.irradiance.emplace_back();
      for (Rgb& c : r) c = {number() - 0.2f, number() - 0.2f, number() - 0.2f};
      out.reflectance.push_back({number(), number(), number()});
      out.emission.push_back(Rgb{1, 1, 1} * (0.1f * number()));
      out.two_sided.push_back(out.triangles.size() % 2);
    }
  }
  return out;
}

class QuadraticTest : public testing::OnDevice {};

TEST_F(QuadraticTest, IsWhatTheProcessorDraws) {
  const scene::Scene scene = scene::cornell_box();
  const display::QuadraticMesh mesh = some_light(scene);
  pipeline::LightmapPages black;
  black.pictures.emplace_back(1, 1, 4);
  black.of_material.assign(scene.materials.size(), 0);
  const auto on_device = put_on_device(*commands_, scene, black);
  ASSERT_TRUE(on_device) << on_device.error().message;
  const auto painter = make_painter(*device_, *shaders_, *on_device, kLitWidth, kLitHeight);
  ASSERT_TRUE(painter) << painter.error().message;
  std::vector<uint32_t> group(mesh.triangles.size(), 5);
  Additions additions;
  auto put = put_quadratics(*device_, mesh, group);
  ASSERT_TRUE(put) << put.error().message;
  additions.instead = std::move(*put);
  Frame frame;
  frame.camera = scene.cameras[0];
  const Canvas canvas{*shaders_, *painter, *on_device, nullptr, &additions};
  const auto seen = painted_radiance(*commands_, canvas, frame);
  ASSERT_TRUE(seen) << seen.error().message;
  const auto view = display::QuadraticView::make(mesh);
  ASSERT_TRUE(view);
  const image::Image wanted = view->draw(frame.camera, kLitWidth, kLitHeight);
  // Pixels that a triangle covers whole: four samples there have the mean of the middle's light.
  size_t compared = 0;
  for (int y = 1; y + 1 < kLitHeight; ++y)
    for (int x = 1; x + 1 < kLitWidth; ++x) {
      const Rgb a = seen->rgb(x, y), b = wanted.rgb(x, y);
      float rough = 0;
      for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
        rough = std::max(rough, max_component(max(wanted.rgb(x + dx, y + dy) - b,
                                                  b - wanted.rgb(x + dx, y + dy))));
      if (rough > 0.03f || seen->at(x, y)[3] < 1) continue;
      ++compared;
      EXPECT_NEAR(max_component(max(a - b, b - a)), 0, 0.006) << x << ' ' << y;
    }
  EXPECT_GT(compared, 800u);
  // Light of pixels counts where their group is that of the surface.
  for (const uint32_t of : {5u, 6u}) {
    struct Known {
      Rgb irradiance;
      uint32_t group;
    };
    const std::vector<Known> known(size_t(kLitWidth * kLitHeight), {{2, 2, 2}, of});
    ExactPixels exact;
    auto pixels = gpu::buffer_with(*device_, std::as_bytes(std::span(known)), "pixels");
    ASSERT_TRUE(pixels) << pixels.error().message;
    exact.pixels = std::move(*pixels), exact.width = kLitWidth;
    additions.exact = std::move(exact);
    frame.show = Show::light;
    const auto radiance = painted_radiance(*commands_, canvas, frame);
    ASSERT_TRUE(radiance) << radiance.error().message;
    const float middle = radiance->rgb(kLitWidth / 2, kLitHeight / 2).x;
    if (of == 5)
      EXPECT_NEAR(middle, 2 / std::numbers::pi, 1e-3);
    else
      EXPECT_LT(middle, 1.9 / std::numbers::pi);
  }
}

}  // namespace
}  // namespace luxel::view
