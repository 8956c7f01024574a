// Shaders that pages show to people who write engines, run on a device as they stand there.
#include <gmock/gmock.h>

#include "luxel/gpu/device_test_support.h"
#include "luxel/gpu/pipeline.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/scene/shapes.h"
#include "tests/page_shader.comp.h"

namespace luxel {
namespace {

class PageShaders : public gpu::testing::OnDevice {
 protected:
  /// Light of a bake's lightmap for a bent normal, by the shader in docs/method/directional.md.
  std::vector<Rgb> sh1(const pipeline::Bake& bake, Vec3 m, Vec3 n) {
    const std::array<const image::Image*, 4> maps{
        &bake.lightmaps.front(), &bake.directions.pictures[0].front(),
        &bake.directions.pictures[1].front(), &bake.directions.pictures[2].front()};
    struct Push {
      std::array<VkDeviceAddress, 5> colors;
      Vec3 m, n;
      uint32_t count;
    } push{{}, m, n, uint32_t(maps[0]->width * maps[0]->height)};
    std::vector<gpu::Buffer> buffers;
    for (size_t k = 0; k < maps.size(); ++k) {
      std::vector<Rgb> colors;
      for (uint32_t i = 0; i < push.count; ++i)
        colors.push_back(maps[k]->rgb(int(i) % maps[k]->width, int(i) / maps[k]->width));
      buffers.push_back(*gpu::buffer_with(*device_, std::as_bytes(std::span(colors)), "a map"));
      push.colors[k] = buffers.back().address;
    }
    const auto out =
        gpu::make_buffer(*device_, push.count * sizeof(Rgb), gpu::Access::to_host, "light");
    push.colors[4] = out->address;
    const auto pipeline =
        gpu::make_compute_pipeline(*device_, page_shader_comp, {sizeof(Push), {}});
    EXPECT_TRUE(pipeline) << pipeline.error().message;
    EXPECT_TRUE(commands_->run([&](VkCommandBuffer commands) {
      gpu::bind(*device_, commands, *pipeline, push);
      device_->vk.vkCmdDispatch(commands, (push.count + 63) / 64, 1, 1);
      gpu::full_barrier(*device_, commands);
    }));
    std::vector<Rgb> light(push.count);
    std::memcpy(light.data(), out->mapped, push.count * sizeof(Rgb));
    return light;
  }
};

// A floor under a red sun and a blue one: E(m) = sum of E_s max(0, m . s), exactly, while m faces
// both.
TEST_F(PageShaders, Sh1IsTheLightOfTwoSuns) {
  scene::Scene scene;
  scene::add_material(scene, "grey", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 0, true, 0);
  const Vec3 red_from = normalize(Vec3{1, 2, 0}), blue_from = normalize(Vec3{-1, 1, 1});
  const Rgb red{4, 1, 0}, blue{0, 1, 7};
  for (const auto& [from, color] : {std::pair(red_from, red), std::pair(blue_from, blue)}) {
    scene::PunctualLight sun;
    sun.kind = scene::PunctualLight::Kind::directional;
    sun.direction = -from, sun.intensity = color;
    scene.lights.push_back(sun);
  }
  pipeline::BakeSettings settings;
  settings.resolution = 16, settings.samples = 8, settings.bounces = 0;
  settings.directional = pipeline::Directional::sh1;
  Progress progress;
  const auto bake = pipeline::bake_scene(std::move(scene), settings, progress);
  ASSERT_TRUE(bake) << bake.error().message;
  for (const Vec3 bent : {Vec3{0, 1, 0}, Vec3{0.2f, 1, 0.3f}, Vec3{-0.4f, 1, 0}}) {
    const Vec3 m = normalize(bent);
    const Rgb expected = red * dot(m, red_from) + blue * dot(m, blue_from);
    const std::vector<Rgb> found = sh1(*bake, m, {0, 1, 0});
    size_t lit = 0;
    for (const atlas::Texel& texel : bake->map.texels) {
      const Rgb e = found[size_t(texel.y) * 16 + texel.x];
      ++lit;
      for (const auto& [is, should] :
           {std::pair(e.x, expected.x), std::pair(e.y, expected.y), std::pair(e.z, expected.z)})
        ASSERT_NEAR(is, should, 1e-3f * should);  // floats, through tilts by 0.7 rad and back
    }
    EXPECT_GT(lit, 100u);
  }
}

}  // namespace
}  // namespace luxel
