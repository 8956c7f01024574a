// The judge on a graphics device: path tracing by the estimator of reference/path_tracer.h.
#pragma once

#include <memory>

#include "luxel/gpu/device.h"
#include "luxel/reference/path_device.h"

namespace luxel::reference {

/// Paths of one scene on a device: those of irradiance_by_paths() and radiance_by_paths(), with
/// their random numbers, up to rounding. It knows no coloured glass, no surfaces that scatter light
/// through, and no light profiles. Everything that it is made with is kept by reference and must
/// outlive it. While it is made, triangles take some 400 bytes each here. One thread at a time uses
/// it.
class DevicePathTracer {
 public:
  /// Errors: what the device does not know, or no double precision (ErrorCode::unsupported), no
  /// memory, the device is lost.
  static Result<DevicePathTracer> make(const gpu::Device& device, const scene::Scene& scene,
                                       const trace::RayTracer& tracer);
  DevicePathTracer(DevicePathTracer&&) noexcept;
  DevicePathTracer& operator=(DevicePathTracer&&) noexcept;
  ~DevicePathTracer();

  /// irradiance_by_paths(); receivers are not `is_one_place`. Errors: cancelled, no memory, the
  /// device is lost.
  Result<TexelPaths> irradiance(const Receivers& receivers, const PathParams& params,
                                Progress& progress);

  /// radiance_by_paths(). Errors: as above.
  Result<Picture> radiance(const scene::Camera& camera, int width, int height,
                           const PathParams& params, Progress& progress);

 private:
  struct Impl;
  explicit DevicePathTracer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// `device` is kept by reference and must outlive it.
std::unique_ptr<PathDevice> path_device(const gpu::Device& device);

}  // namespace luxel::reference
