// A device computes and draws what is known without one. Without a device these tests are skipped.
#include <gmock/gmock.h>

#include <chrono>
#include <cstring>
#include <numeric>
#include <thread>

#include "luxel/gpu/device_test_support.h"
#include "luxel/gpu/pieces.h"
#include "luxel/gpu/pipeline.h"
#include "luxel/gpu/shaders/test_double.comp.h"
#include "luxel/gpu/shaders/test_fields.comp.h"
#include "luxel/gpu/shaders/test_triangle.frag.h"
#include "luxel/gpu/shaders/test_triangle.vert.h"
#include "luxel/gpu/target.h"
#include "luxel/gpu/test_support_shared.h"

namespace luxel::gpu {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

DeviceParams validated() {
  DeviceParams params;
  params.validate = true;
  return params;
}

DeviceParams named(std::string name) {
  DeviceParams params;
  params.name = std::move(name);
  return params;
}

class Gpu : public testing::OnDevice {
 protected:
  /// An opaque picture of one colour.
  Picture picture_of(std::array<uint8_t, 4> rgba, uint32_t width, uint32_t height) {
    std::vector<std::byte> pixels(4 * size_t(width) * height);
    for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = std::byte(rgba[i % 4]);
    PictureParams params;
    params.width = width, params.height = height;
    auto picture = picture_with(*commands_, params, pixels, "a test picture");
    EXPECT_TRUE(picture) << picture.error().message;
    return std::move(*picture);
  }
};

/// Items of the pieces of work that takes so long for each, as the processor sees it.
std::vector<size_t> pieces_of(Commands& commands, size_t count, size_t most, double seconds_each,
                              PieceSize& size) {
  std::vector<size_t> out;
  size_t next = 0;
  EXPECT_TRUE(
      run_in_pieces(commands, count, most, size, [&](VkCommandBuffer, size_t first, size_t some) {
        EXPECT_EQ(first, next);
        next += some, out.push_back(some);
        std::this_thread::sleep_for(std::chrono::duration<double>(seconds_each * double(some)));
      }));
  EXPECT_EQ(next, count);
  return out;
}

// Pieces follow each other without a gap. They grow fourfold at most, until one takes 20 ms by what
// the last has taken, and stay below what there may be at most. A machine that is busy makes them
// smaller, never larger.
TEST_F(Gpu, WorksInPiecesOfSomeMilliseconds) {
  PieceSize size{4};
  const std::vector<size_t> slow = pieces_of(*commands_, 300, 1000, 1e-3, size);
  EXPECT_EQ(slow.front(), 4u);
  for (size_t k = 1; k < slow.size(); ++k)
    EXPECT_LE(slow[k], std::min<size_t>(4 * slow[k - 1], 20));
  size = {4};
  const std::vector<size_t> quick = pieces_of(*commands_, 300, 50, 0, size);
  EXPECT_GT(quick[1], 4u);
  for (const size_t some : quick) EXPECT_LE(some, 50u);
  // A piece that was cut short by the end does not make the next ones small.
  size = {100};
  EXPECT_EQ(pieces_of(*commands_, 3, 1000, 0, size), std::vector<size_t>{3});
  EXPECT_EQ(size.items, 100u);
}

TEST_F(Gpu, StopsBetweenPieces) {
  Progress progress;
  PieceSize size{1};
  int pieces = 0;
  const auto done = run_in_pieces(
      *commands_, 100, 1, size,
      [&](VkCommandBuffer, size_t, size_t) {
        if (++pieces == 3) progress.request_cancel();
      },
      &progress);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::cancelled);
  EXPECT_EQ(pieces, 3);
}

TEST_F(Gpu, ComputesOnABuffer) {
  constexpr uint32_t kCount = 1000;  // no multiple of a work group's 64
  std::vector<uint32_t> numbers(kCount + 1);
  std::iota(numbers.begin(), numbers.end(), 0);
  const auto buffer = buffer_with(*device_, std::as_bytes(std::span(numbers)), "numbers");
  ASSERT_TRUE(buffer) << buffer.error().message;
  struct Push {
    VkDeviceAddress numbers;
    uint32_t count;
  } const push{buffer->address, kCount};
  const auto pipeline = make_compute_pipeline(*device_, test_double_comp, {12, {}});
  ASSERT_TRUE(pipeline) << pipeline.error().message;
  ASSERT_TRUE(commands_->run([&](VkCommandBuffer commands) {
    device_->vk.vkCmdBindPipeline(commands, pipeline->point, pipeline->pipeline.get());
    device_->vk.vkCmdPushConstants(commands, pipeline->layout.get(), pipeline->stages, 0, 12,
                                   &push);
    device_->vk.vkCmdDispatch(commands, (kCount + 63) / 64, 1, 1);
    full_barrier(*device_, commands);
  }));
  std::memcpy(numbers.data(), buffer->mapped, 4 * numbers.size());
  for (uint32_t i = 0; i < kCount; ++i) ASSERT_EQ(numbers[i], 2 * i);
  EXPECT_EQ(numbers[kCount], kCount) << "beyond the end";
}

// Members are numbered by their places in the shader: each differs from those beside it.
TEST_F(Gpu, FindsEachMemberWhereTheHostWritesIt) {
  if (!device_->has_doubles) GTEST_SKIP() << "the device has no double precision";
  using namespace on_device;
  std::vector<gpu::Buffer> held;
  const auto address_of = [&](const auto& values) {
    auto buffer = buffer_with(*device_, std::as_bytes(std::span(values)), "a test's buffer");
    EXPECT_TRUE(buffer) << buffer.error().message;
    held.push_back(std::move(*buffer));
    return held.back().address;
  };
  const TestBlock block{
      .whole = 2, .three = {3, 4, 5}, .floats = address_of(std::array<float, 2>{-1, 6})};
  TestFields fields{.whole = 1,
                    .block = address_of(std::array{block}),
                    .negative = 7,
                    .fine = 8,
                    .two = {9, 10},
                    .three = {11, 12, 13},
                    .seed = halves(uint64_t(15) << 32 | 14),
                    .some = {16, 17, 18},
                    .pair = {19, 20},
                    .pairs = {TestPair{21, 22}, TestPair{23, 24}},
                    .matrix = {}};
  fields.matrix[2 * 4 + 1] = 25;
  const auto answers =
      make_buffer(*device_, kTestFields * sizeof(float), Access::to_host, "answers");
  ASSERT_TRUE(answers) << answers.error().message;
  const TestPush push{.last = 29,
                      .fields = address_of(std::array{fields}),
                      .pairs = address_of(std::array{TestPair{-1, -1}, TestPair{26, 27}}),
                      .vectors = address_of(std::array<float, 8>{-1, -1, -1, -1, -1, -1, -1, 28}),
                      .numbers = address_of(std::array<uint, 1>{0}),
                      .answers = answers->address};
  const auto pipeline = make_compute_pipeline(*device_, test_fields_comp, {sizeof push, {}});
  ASSERT_TRUE(pipeline) << pipeline.error().message;
  ASSERT_TRUE(commands_->run([&](VkCommandBuffer commands) {
    bind(*device_, commands, *pipeline, push);
    device_->vk.vkCmdDispatch(commands, 1, 1, 1);
    full_barrier(*device_, commands);
  }));
  std::vector<float> found(kTestFields);
  std::memcpy(found.data(), answers->mapped, kTestFields * sizeof(float));
  for (uint k = 0; k < kTestFields; ++k) EXPECT_EQ(found[k], float(k + 1));
}

TEST_F(Gpu, DrawsTheMeanOfSamples) {
  // Left half of an 8 x 8 picture and the left half of its fifth column; behind it all of it in
  // black, which is farther away.
  const float right = 0.125f;
  const std::array<std::array<float, 4>, 6> half{{{-1, -1, 0.5f, 1},
                                                  {-1, 1, 0.5f, 1},
                                                  {right, 1, 0.5f, 1},
                                                  {-1, -1, 0.5f, 1},
                                                  {right, 1, 0.5f, 1},
                                                  {right, -1, 0.5f, 1}}};
  const Picture white = picture_of({255, 255, 255, 255}, 2, 2);
  const auto sampler = make_sampler(*device_, {});
  ASSERT_TRUE(sampler);
  TargetParams target_params{8, 8, VK_FORMAT_R16G16B16A16_SFLOAT, VK_SAMPLE_COUNT_4_BIT, true};
  const auto target = make_target(*device_, target_params, "a target");
  ASSERT_TRUE(target) << target.error().message;
  DrawParams params;
  params.vertex = test_triangle_vert, params.fragment = test_triangle_frag;
  params.interface = {24, {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER}};
  params.colors = {target_params.color};
  params.depth = VK_FORMAT_D32_SFLOAT;
  params.samples = target_params.samples;
  params.cull = VK_CULL_MODE_BACK_BIT;
  const auto pipeline = make_draw_pipeline(*device_, params);
  ASSERT_TRUE(pipeline) << pipeline.error().message;
  const std::vector<Binding> bindings{{&white, sampler->get()}};
  const auto sets = make_sets(*device_, *pipeline, std::span(&bindings, 1));
  ASSERT_TRUE(sets) << sets.error().message;
  const auto corners = buffer_with(*device_, std::as_bytes(std::span(half)), "corners");
  ASSERT_TRUE(corners) << corners.error().message;
  struct Push {
    VkDeviceAddress corners;
    std::array<float, 4> color;
  } const push{corners->address, {2, 0.5f, 0.25f, 1}};
  ASSERT_TRUE(commands_->run([&](VkCommandBuffer commands) {
    begin_drawing(*device_, commands, *target, {0, 0, 0, 1});
    bind(*device_, commands, *pipeline, push);
    bind_set(*device_, commands, *pipeline, sets->sets[0]);
    device_->vk.vkCmdDraw(commands, 6, 1, 0, 0);
    end_drawing(*device_, commands, *target, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  }));
  const auto pixels = pixels_of(*commands_, target->picture);
  ASSERT_TRUE(pixels) << pixels.error().message;
  const auto red = [&](size_t x, size_t y) {
    uint16_t half_float = 0;
    std::memcpy(&half_float, pixels->data() + 8 * (8 * y + x), 2);
    return half_float;
  };
  for (size_t y = 0; y < 8; ++y) {
    EXPECT_EQ(red(0, y), 0x4000) << "2 as a half, " << y;
    EXPECT_EQ(red(3, y), 0x4000);
    EXPECT_EQ(red(4, y), 0x3c00) << "half of the samples: 1";
    EXPECT_EQ(red(5, y), 0);
  }
}

// A map of shadows: what is in a part is lost there and drawn, and the rest stays.
TEST_F(Gpu, DepthAloneIsDrawnIntoAPart) {
  // The left half of a part, at a depth that a float holds.
  const std::array<std::array<float, 4>, 6> half{{{-1, -1, 0.25f, 1},
                                                  {-1, 1, 0.25f, 1},
                                                  {0, 1, 0.25f, 1},
                                                  {-1, -1, 0.25f, 1},
                                                  {0, 1, 0.25f, 1},
                                                  {0, -1, 0.25f, 1}}};
  PictureParams picture_params;
  picture_params.format = VK_FORMAT_D32_SFLOAT;
  picture_params.width = picture_params.height = 16;
  picture_params.usage =
      VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  const auto depth = make_picture(*device_, picture_params, "a depth");
  ASSERT_TRUE(depth) << depth.error().message;
  DrawParams params;
  params.vertex = test_triangle_vert;
  params.interface = {24, {}};
  params.depth = VK_FORMAT_D32_SFLOAT;
  const auto pipeline = make_draw_pipeline(*device_, params);
  ASSERT_TRUE(pipeline) << pipeline.error().message;
  const auto corners = buffer_with(*device_, std::as_bytes(std::span(half)), "corners");
  ASSERT_TRUE(corners) << corners.error().message;
  struct Push {
    VkDeviceAddress corners;
    std::array<float, 4> color;
  } const push{corners->address, {}};
  constexpr VkImageLayout kDepth = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
  ASSERT_TRUE(commands_->run([&](VkCommandBuffer commands) {
    change_layout(*device_, commands, *depth, VK_IMAGE_LAYOUT_UNDEFINED, kDepth);
    // All of it, then a part over it, which is cleared first.
    for (const VkRect2D& part : {VkRect2D{{0, 0}, {16, 16}}, VkRect2D{{0, 8}, {8, 8}}}) {
      begin_drawing_depth(*device_, commands, *depth, part);
      bind(*device_, commands, *pipeline, push);
      device_->vk.vkCmdDraw(commands, 6, 1, 0, 0);
      device_->vk.vkCmdEndRenderingKHR(commands);
      full_barrier(*device_, commands);
    }
    change_layout(*device_, commands, *depth, kDepth, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  }));
  const auto pixels = pixels_of(*commands_, *depth);
  ASSERT_TRUE(pixels) << pixels.error().message;
  for (size_t y = 0; y < 16; ++y)
    for (size_t x = 0; x < 16; ++x) {
      float value = 0;
      std::memcpy(&value, pixels->data() + 4 * (16 * y + x), 4);
      EXPECT_EQ(value, x < (y < 8 ? 8u : 4u) ? 0.25f : 0) << x << " " << y;
    }
}

TEST_F(Gpu, AveragesMipmaps) {
  std::vector<std::byte> pixels;
  for (const int v : {0, 40, 80, 120})
    for (const int alpha : {v, v, v, 255}) pixels.push_back(std::byte(alpha));
  PictureParams params;
  params.width = params.height = 2;
  params.levels = full_levels(2, 2);
  ASSERT_EQ(params.levels, 2u);
  const auto picture = picture_with(*commands_, params, pixels, "a picture");
  ASSERT_TRUE(picture) << picture.error().message;
  // Level 1 in a picture of its own.
  PictureParams small = params;
  small.width = small.height = small.levels = 1;
  small.usage |= VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  const auto level = make_picture(*device_, small, "a level");
  ASSERT_TRUE(level) << level.error().message;
  ASSERT_TRUE(commands_->run([&](VkCommandBuffer commands) {
    change_layout(*device_, commands, *picture, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                  VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    change_layout(*device_, commands, *level, VK_IMAGE_LAYOUT_UNDEFINED,
                  VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    VkImageCopy copy{};
    copy.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 1, 0, 1};
    copy.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.extent = {1, 1, 1};
    device_->vk.vkCmdCopyImage(commands, picture->image.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                               level->image.get(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    change_layout(*device_, commands, *level, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                  VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  }));
  const auto mean = pixels_of(*commands_, *level);
  ASSERT_TRUE(mean) << mean.error().message;
  EXPECT_EQ(int((*mean)[0]), 60);
  EXPECT_EQ(int((*mean)[3]), 255);
  const auto first = pixels_of(*commands_, *picture);
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(*first, pixels);
}

TEST_F(Gpu, RefusesPicturesLargerThanItsLimit) {
  PictureParams params;
  params.width = device_->limits.maxImageDimension2D + 1, params.height = 1;
  const auto picture = make_picture(*device_, params, "the lightmap");
  ASSERT_FALSE(picture);
  EXPECT_THAT(picture.error().message, HasSubstr("the lightmap: "));
}

TEST_F(Gpu, WorkIsDoneInOrder) {
  // Each doubles what the one before left; the numbers to wait for go up.
  const std::vector<uint32_t> one{1};
  const auto buffer = buffer_with(*device_, std::as_bytes(std::span(one)), "a number");
  ASSERT_TRUE(buffer);
  const auto pipeline = make_compute_pipeline(*device_, test_double_comp, {12, {}});
  ASSERT_TRUE(pipeline);
  struct Push {
    VkDeviceAddress numbers;
    uint32_t count;
  } const push{buffer->address, 1};
  uint64_t last = 0;
  for (int i = 0; i < 20; ++i) {
    const auto number = commands_->submit([&](VkCommandBuffer commands) {
      full_barrier(*device_, commands);
      device_->vk.vkCmdBindPipeline(commands, pipeline->point, pipeline->pipeline.get());
      device_->vk.vkCmdPushConstants(commands, pipeline->layout.get(), pipeline->stages, 0, 12,
                                     &push);
      device_->vk.vkCmdDispatch(commands, 1, 1, 1);
      full_barrier(*device_, commands);
    });
    ASSERT_TRUE(number);
    EXPECT_GT(*number, last);
    last = *number;
  }
  ASSERT_TRUE(commands_->wait(last));
  uint32_t value = 0;
  std::memcpy(&value, buffer->mapped, 4);
  EXPECT_EQ(value, 1u << 20);
}

// The validation layer's messages arrive: what the other tests find empty would not be.
TEST(GpuMessages, SayWhatIsWrong) {
  auto device = Device::open(validated());
  if (!device) GTEST_SKIP() << device.error().message;
  auto info = structure<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = 0;  // not allowed
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  (*device)->vk.vkCreateBuffer((*device)->device, &info, nullptr, &buffer);
  ASSERT_FALSE((*device)->messages().empty());
  EXPECT_THAT((*device)->messages()[0], HasSubstr("size"));
  if (buffer != VK_NULL_HANDLE) (*device)->vk.vkDestroyBuffer((*device)->device, buffer, nullptr);
}

TEST(GpuDevices, AreChosenByName) {
  const auto devices = list_devices();
  if (!devices) GTEST_SKIP() << devices.error().message;
  ASSERT_FALSE(devices->empty());
  const auto none = Device::open(named("no such card"));
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::no_device);
  EXPECT_THAT(none.error().message, HasSubstr("has 'no such card' in its name"));
  EXPECT_THAT(none.error().message, HasSubstr(devices->front().name));
  std::string name = devices->front().name.substr(0, 5);
  for (char& c : name) c = char(std::toupper(uint8_t(c)));
  if (devices->front().lacks.empty()) {
    EXPECT_TRUE(Device::open(named(name)));
  }
}

}  // namespace
}  // namespace luxel::gpu
