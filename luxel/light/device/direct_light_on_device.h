// Light that arrives straight from the sources, worked out by a graphics device.
#pragma once

#include <memory>

#include "luxel/light/device/device_lights.h"
#include "luxel/light/direct_light.h"

namespace luxel::light {

/// Direct light of one scene on a device, by the same shadow rays as light::direct_light(), up to
/// rounding: those of each element have the same seed. Where both triangles and punctual lights are
/// drawn, the variance of either is estimated for itself. Everything that it is made with is kept
/// by reference and must outlive it. One thread at a time uses it.
class DeviceDirectLight {
 public:
  /// The device has double precision (gpu::Device::has_doubles) and knows all of the lights
  /// (device_knows()), and nothing in the scene tints light. Errors: no memory, the driver does not
  /// take a shader, the device is lost.
  static Result<DeviceDirectLight> make(const trace::DeviceRayTracer& tracer,
                                        gpu::Commands& commands, const scene::Scene& scene,
                                        const Lights& lights);

  /// light::direct_light_again(), without parts, layers and sky_samples: the light of some elements
  /// in place of what is there. Errors: cancelled, no memory, the device is lost; `direct` is of no
  /// use then.
  Status direct_light_again(const transport::Elements& elements, std::span<const uint32_t> which,
                            const DirectParams& params, DirectLight& direct, Progress& progress);

  /// That of all elements, from scratch. Errors: as above.
  Result<DirectLight> direct_light(const transport::Elements& elements, const DirectParams& params,
                                   Progress& progress);

  /// Seconds that the device has worked, as the processor sees them.
  double seconds() const { return seconds_; }

 private:
  struct Step {
    gpu::Pipeline pipeline;
    gpu::PieceSize piece{64};  ///< of groups of 64 elements
  };

  explicit DeviceDirectLight(gpu::Commands& commands) : commands_(&commands) {}
  Status make_steps(const trace::DeviceRayTracer& tracer, const Lights& lights);
  Status make_room(size_t count);
  Status light_some(size_t count, int samples, const Progress& progress);

  gpu::Commands* commands_;
  DeviceLights lights_;
  std::vector<Step> steps_;
  gpu::Buffer sent_, receivers_, light_, answered_;
  size_t room_ = 0;  ///< elements that the buffers have room for
  double seconds_ = 0;
};

}  // namespace luxel::light
