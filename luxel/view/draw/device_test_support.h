// What tests that draw share: a device under the validation layer, which has nothing to say.
#pragma once

#include <gmock/gmock.h>

#include <memory>
#include <optional>

#include "luxel/view/draw/painter.h"

namespace luxel::view::testing {

/// Skips its tests where there is no device.
class OnDevice : public ::testing::Test {
 protected:
  void SetUp() override {
    gpu::DeviceParams params;
    params.validate = true;
    auto opened = gpu::Device::open(params);
    if (!opened) GTEST_SKIP() << opened.error().message;
    device_ = std::move(*opened);
    auto commands = gpu::Commands::make(*device_);
    ASSERT_TRUE(commands) << commands.error().message;
    commands_.emplace(std::move(*commands));
    auto shaders = make_shaders(*device_);
    ASSERT_TRUE(shaders) << shaders.error().message;
    shaders_.emplace(std::move(*shaders));
  }
  void TearDown() override {
    shaders_.reset();
    commands_.reset();
    if (device_) {
      EXPECT_THAT(device_->messages(), ::testing::IsEmpty());
    }
  }

  std::unique_ptr<gpu::Device> device_;
  std::optional<gpu::Commands> commands_;
  std::optional<Shaders> shaders_;
};

}  // namespace luxel::view::testing
