#include "luxel/trace/embree/embree_version.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

namespace luxel::trace {

EmbreeVersion embree_version() {
  EmbreeVersion out{RTC_VERSION_STRING};
  RTCDevice device = rtcNewDevice(nullptr);
  if (!device) return out;
  const auto has = [&](RTCDeviceProperty property) {
    return rtcGetDeviceProperty(device, property) != 0;
  };
  const auto version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
  out.number = fmt::format("{}.{}.{}", version / 10000, version / 100 % 100, version % 100);
  out.rays_in_a_packet = has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)  ? 16
                         : has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) ? 8
                                                                          : 4;
  rtcReleaseDevice(device);
  return out;
}

}  // namespace luxel::trace
