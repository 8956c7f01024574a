// Light that arrives straight from the sources, worked out by a graphics device.
#pragma once

#include <map>

#include "luxel/light/device/device_lights.h"
#include "luxel/light/light_device.h"

namespace luxel::light {

/// Direct light of one scene on a device. Everything that it is made with is kept by reference and
/// must outlive it.
class DeviceDirectLight final : public LightDevice {
 public:
  /// The device has double precision (gpu::Device::has_doubles) and knows all of the lights
  /// (device_knows()), and nothing in the scene tints light. Errors: no memory, the driver does not
  /// take a shader, the device is lost.
  static Result<DeviceDirectLight> make(const trace::DeviceRayTracer& tracer,
                                        gpu::Commands& commands, const scene::Scene& scene,
                                        const Lights& lights);

  Result<uint64_t> light_at(std::span<const Receiver> receivers, const LightAsked& asked,
                            std::span<LightAt> out, Progress& progress) override;

  /// Seconds that the device has worked, as the processor sees them.
  double seconds() const { return seconds_; }

 private:
  struct Step {
    gpu::Pipeline pipeline;
    bool is_punctual = false;
    std::map<int, gpu::PieceSize> pieces;  ///< of groups of 64 receivers, by their samples
  };

  explicit DeviceDirectLight(gpu::Commands& commands) : commands_(&commands) {}
  Status make_steps(const trace::DeviceRayTracer& tracer, const Lights& lights);
  Status make_room(size_t count);
  Status light_sent(size_t count, const LightAsked& asked, const Progress& progress);

  gpu::Commands* commands_;
  DeviceLights lights_;
  std::vector<Step> steps_;
  gpu::Buffer sent_, receivers_, light_, answered_;
  size_t room_ = 0;  ///< receivers that the buffers have room for
  double seconds_ = 0;
};

}  // namespace luxel::light
