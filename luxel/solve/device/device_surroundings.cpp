#include "luxel/solve/device/device_surroundings.h"

#include "luxel/solve/device/surroundings_shared.h"

namespace luxel::device {
Result<DeviceSurroundings> upload_surroundings(gpu::Commands& commands,
                                               const scene::Environment& map,
                                               const light::Surroundings& around) {
  constexpr std::string_view kWhat = "the buffer of the surroundings";
  static constexpr Rgb kNone{};  // a buffer is never empty
  const std::span<const Rgb> pixels =
      map.empty() ? std::span(&kNone, 1) : std::span<const Rgb>(map.radiance);
  DeviceSurroundings out;
  LUXEL_TRY(out.pixels, gpu::uploaded(commands, std::as_bytes(pixels), kWhat));
  const on_device::Surroundings values{.background = around.background,
                                       .limit = around.limit,
                                       .width = map.empty() ? 0 : map.width,
                                       .height = map.empty() ? 0 : map.height,
                                       .rotation_rad = map.rotation_rad,
                                       .pixels = out.pixels.address};
  LUXEL_TRY(out.values, gpu::uploaded(commands, std::as_bytes(std::span(&values, 1)), kWhat));
  return out;
}

}  // namespace luxel::device
