// A device that tests share: it runs under the validation layer, which must stay silent.
#pragma once

#include <gmock/gmock.h>

#include <memory>
#include <optional>

#include "luxel/gpu/commands.h"

namespace luxel::gpu::testing {

/// Skips its tests where there is no device.
class OnDevice : public ::testing::Test {
 protected:
  void SetUp() override {
    DeviceParams params;
    params.validate = true;
    auto opened = Device::open(params);
    if (!opened) GTEST_SKIP() << opened.error().message;
    device_ = std::move(*opened);
    auto commands = Commands::make(*device_);
    ASSERT_TRUE(commands) << commands.error().message;
    commands_.emplace(std::move(*commands));
  }
  void TearDown() override {
    commands_.reset();
    if (device_) {
      EXPECT_THAT(device_->messages(), ::testing::IsEmpty());
    }
  }

  std::unique_ptr<Device> device_;
  std::optional<Commands> commands_;
};

}  // namespace luxel::gpu::testing
