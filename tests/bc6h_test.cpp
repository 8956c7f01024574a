// Blocks of BC6H as a graphics device sees them: who decodes them is not luxel.
#include <gmock/gmock.h>

#include "luxel/gpu/device_test_support.h"
#include "luxel/gpu/picture.h"
#include "luxel/image/bc6h.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/scene/procedural.h"

namespace luxel {
namespace {

class Bc6h : public gpu::testing::OnDevice {
 protected:
  /// The device's numbers for encode_bc6h()'s blocks, four for each pixel.
  std::vector<float> decoded(const image::HalfImage& half) {
    const std::vector<std::byte> blocks = image::encode_bc6h(half);
    const auto in = gpu::buffer_with(*device_, blocks, "blocks");
    gpu::PictureParams params;
    params.width = uint32_t(half.width), params.height = uint32_t(half.height);
    params.format = VK_FORMAT_BC6H_UFLOAT_BLOCK;
    params.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                   VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    const auto compressed = gpu::make_picture(*device_, params, "a BC6H picture");
    params.format = VK_FORMAT_R32G32B32A32_SFLOAT;
    const auto plain = gpu::make_picture(*device_, params, "a picture of floats");
    EXPECT_TRUE(in && compressed && plain);
    const VkOffset3D end{half.width, half.height, 1};
    const Status done = commands_->run([&](VkCommandBuffer commands) {
      constexpr auto kNew = VK_IMAGE_LAYOUT_UNDEFINED;
      constexpr auto kFrom = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
      constexpr auto kTo = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
      gpu::change_layout(*device_, commands, *compressed, kNew, kTo);
      VkBufferImageCopy copy{};
      copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
      copy.imageExtent = {uint32_t(half.width), uint32_t(half.height), 1};
      device_->vk.vkCmdCopyBufferToImage(commands, in->buffer.get(), compressed->image.get(), kTo,
                                         1, &copy);
      gpu::change_layout(*device_, commands, *compressed, kTo, kFrom);
      gpu::change_layout(*device_, commands, *plain, kNew, kTo);
      VkImageBlit blit{};
      blit.srcSubresource = blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
      blit.srcOffsets[1] = blit.dstOffsets[1] = end;
      device_->vk.vkCmdBlitImage(commands, compressed->image.get(), kFrom, plain->image.get(), kTo,
                                 1, &blit, VK_FILTER_NEAREST);
      gpu::change_layout(*device_, commands, *plain, kTo, kFrom);
    });
    EXPECT_TRUE(done) << done.error().message;
    const auto bytes = gpu::pixels_of(*commands_, *plain);
    EXPECT_TRUE(bytes) << bytes.error().message;
    std::vector<float> out(bytes->size() / sizeof(float));
    std::memcpy(out.data(), bytes->data(), bytes->size());
    return out;
  }
};

image::Image image_of(int width, int height, const std::function<Rgb(int, int)>& color) {
  image::Image out(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) out.set_rgb(x, y, color(x, y));
  return out;
}

// All halves of one exponent, black, and the largest: a block of one colour loses nothing.
TEST_F(Bc6h, KeepsBlocksOfOneColor) {
  const image::Image flat = image_of(128, 132, [](int x, int y) {
    const int block = x / 4 + y / 4 * 32;
    if (block == 0) return Rgb{};
    if (block == 1) return Rgb{65504, 0, 65504};
    const float g = 1 + float(block % 1024) / 1024;
    return Rgb{g, 1.5f * g, 4000 * g};
  });
  const image::HalfImage half = image::to_half(flat, 1);
  const std::vector<float> found = decoded(half);
  ASSERT_EQ(found.size(), 4 * half.data.size() / 3);
  for (size_t i = 0; i < half.data.size(); ++i)
    ASSERT_EQ(found[i / 3 * 4 + i % 3], image::from_half(half.data[i])) << i;
}

// Light of a lamp 20 pixels above the corner, which falls to a sixtieth; no side is a multiple
// of 4.
TEST_F(Bc6h, KeepsSmoothLight) {
  const image::Image smooth = image_of(70, 45, [](int x, int y) {
    const float r2 = float(x * x + y * y) + 400;
    return Rgb{8e6f, 6e6f, 3e6f} * (1 / (r2 * std::sqrt(r2)));
  });
  const std::vector<float> found = decoded(image::to_half(smooth, 1));
  for (size_t i = 0; i < smooth.data.size(); ++i)
    // A block spans up to half an octave, 500 of a half's steps. Colours between its ends are up to
    // 5/64 of that apart, so a pixel is up to 20 of 1024 steps off, and ends of 11 bits 8 more.
    // Halves are no logarithms, so three channels leave the line by some ten steps.
    ASSERT_NEAR(found[i / 3 * 4 + i % 3] / smooth.data[i], 1, 0.04) << i;
}

// Both ways round, and each kind of block: neighbours that differ by much, by some, and by little.
TEST_F(Bc6h, KeepsTheEndsOfEdges) {
  for (const float ratio : {1.002f, 1.3f, 3.0f, 300.0f})
    for (const bool first_is_dark : {false, true}) {
      const image::Image edge = image_of(4, 4, [&](int x, int) {
        return (x < 2) == first_is_dark ? Rgb{1, 2, 3} : Rgb{1, 2, 3} * ratio;
      });
      const std::vector<float> found = decoded(image::to_half(edge, 1));
      for (size_t i = 0; i < edge.data.size(); ++i)
        // Half of a step of 10 bits, 32 of a half's 1024 per octave.
        ASSERT_NEAR(found[i / 3 * 4 + i % 3] / edge.data[i], 1, 0.016) << ratio << " " << i;
    }
}

// Colours that differ at a right angle to grey, where a search that begins with grey finds nothing.
TEST_F(Bc6h, TellsRedFromGreen) {
  const image::Image edge = image_of(4, 4, [](int x, int) {
    return x < 2 ? Rgb{2, 1, 1} : Rgb{1, 2, 1};
  });
  const std::vector<float> found = decoded(image::to_half(edge, 1));
  for (size_t i = 0; i < edge.data.size(); ++i)
    ASSERT_NEAR(found[i / 3 * 4 + i % 3] / edge.data[i], 1, 0.016) << i;  // as above
}

TEST_F(Bc6h, LooksAtNoTexelThatIsNotThere) {
  image::Image image(4, 4, 4);
  for (int i = 0; i < 16; ++i)
    if (i % 4 < 2)
      image.set_rgb(i % 4, i / 4, {1 + float(i) / 16, 1, 1}), image.at(i % 4, i / 4)[3] = 1;
  const std::vector<float> found = decoded(image::to_half(image, 1));
  for (int i = 0; i < 16; ++i)
    if (i % 4 < 2) {
      EXPECT_NEAR(found[size_t(4 * i)], 1 + float(i) / 16, 0.03) << i;
    }
}

TEST_F(Bc6h, KeepsALightmap) {
  pipeline::BakeSettings settings;
  settings.resolution = 128, settings.samples = 16, settings.denoise = true;
  Progress progress;
  const auto bake = pipeline::bake_scene(scene::cornell_box(), settings, progress);
  ASSERT_TRUE(bake) << bake.error().message;
  const image::Image& lightmap = bake->lightmaps.front();
  const std::vector<float> found = decoded(image::to_half(lightmap, 1));
  double mean = 0, squares = 0;
  for (const Rgb e : bake->light.irradiance)
    mean += double(length(e)) / double(bake->light.irradiance.size());
  std::vector<float> relative;  // dark texels: to a tenth of the mean
  for (size_t i = 0; i < lightmap.data.size() / 4; ++i) {
    if (lightmap.data[4 * i + 3] == 0) continue;
    const Rgb is{found[4 * i], found[4 * i + 1], found[4 * i + 2]};
    const Rgb was{lightmap.data[4 * i], lightmap.data[4 * i + 1], lightmap.data[4 * i + 2]};
    relative.push_back(length(is - was) / std::max(length(was), float(0.1 * mean)));
    squares += double(relative.back()) * double(relative.back());
  }
  std::ranges::sort(relative);
  const double rms = std::sqrt(squares / double(relative.size()));
  const float p99 = relative[relative.size() * 99 / 100];
  RecordProperty("rms", std::to_string(rms)), RecordProperty("p99", std::to_string(p99));
  EXPECT_LT(rms, 0.04);  // what docs/format/bake.md says
  EXPECT_LT(p99, 0.12);
}

}  // namespace
}  // namespace luxel
