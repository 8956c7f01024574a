// Light that moves, relit by a graphics device. [Shcherbakov17, section 3.6]
#pragma once

#include <memory>

#include "luxel/gpu/device.h"
#include "luxel/solve/matrix/relighter.h"

namespace luxel::device {

/// A matrix::Relighter on a device: direct light at patches by shadow rays, the product by the
/// hierarchical codec or by BC1 blocks, all bounces, and the light of texels or vertices. One
/// command buffer for each update, and some before it where shadow rays are many. `device` and the
/// data are kept by reference and must outlive it. One thread at a time uses it.
class DeviceRelighter {
 public:
  /// Errors: another codec (ErrorCode::unsupported), no memory, the device is lost.
  static Result<DeviceRelighter> make(const gpu::Device& device, const matrix::RelightData& data);
  DeviceRelighter(DeviceRelighter&&) noexcept;
  DeviceRelighter& operator=(DeviceRelighter&&) noexcept;
  ~DeviceRelighter();

  /// E of patches and points after all bounces, up to rounding that of matrix::Relighter; without
  /// light at points straight from lights. Punctual lights may be any number. Errors: no memory,
  /// the device is lost.
  Status update(const matrix::RelightLights& lights);

  /// Copies the light of the last update to the processor: Relit::direct, indirect and
  /// indirect_at_points. Errors: no memory, the device is lost.
  Status read(matrix::Relit& out);

  /// Rgb of each point of RelightData::target after the last update, for shaders on this device.
  VkDeviceAddress indirect_at_points() const;

  /// The time of the last update() [s].
  double seconds() const;

 private:
  struct Impl;
  explicit DeviceRelighter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace luxel::device
