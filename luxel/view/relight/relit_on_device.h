// Light of all bounces that follows the lamps and stays on the device that draws it.
#pragma once

#include <array>
#include <deque>

#include "luxel/solve/device/device_relighter.h"
#include "luxel/view/draw/device_scene.h"
#include "luxel/view/relight/relit_light.h"

namespace luxel::view {

/// Relights a scene on a device, and makes the lightmap of its places there.
struct RelitOnDevice {
  device::DeviceRelighter relighter;
  std::array<gpu::Pipeline, 4> steps{};  ///< of shaders/relit_map.comp
  std::deque<gpu::Buffer> held{};        ///< whose addresses are in `map`
  gpu::Buffer map{};                     ///< Map of the shader
  gpu::Buffer largest{}, halves{};
  uint32_t place_count = 0, pixel_count = 0;
  std::vector<uint32_t> ring_end{};  ///< MapPlaces::ring_end
};

/// The scene's lightmap is that of `light`, on one page; the data of `light` is kept by reference.
/// Errors: a codec that devices do not know (ErrorCode::unsupported), no memory, the device is
/// lost.
Result<RelitOnDevice> make_relit_on_device(gpu::Commands& commands, const RelitLight& light,
                                           const DeviceScene& scene);

/// The scene's first picture of its lightmap has E after all bounces of these lamps then. Nothing
/// may still draw it. Returns what that took [ms]. Errors: no memory, the device is lost.
Result<RelitLight::Milliseconds> relight_on_device(gpu::Commands& commands, const Lamps& lamps,
                                                   RelitOnDevice& relit, DeviceScene& scene);

}  // namespace luxel::view
