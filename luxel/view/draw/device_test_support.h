// Fixture for tests that draw: a device and its shaders.
#pragma once

#include <gmock/gmock.h>

#include <optional>

#include "luxel/gpu/device_test_support.h"
#include "luxel/view/draw/painter.h"

namespace luxel::view::testing {

/// Skips its tests where there is no device.
class OnDevice : public gpu::testing::OnDevice {
 protected:
  void SetUp() override {
    gpu::testing::OnDevice::SetUp();
    if (!device_ || HasFatalFailure()) return;
    auto shaders = make_shaders(*device_);
    ASSERT_TRUE(shaders) << shaders.error().message;
    shaders_.emplace(std::move(*shaders));
  }
  void TearDown() override {
    shaders_.reset();
    gpu::testing::OnDevice::TearDown();
  }

  std::optional<Shaders> shaders_;
};

}  // namespace luxel::view::testing
