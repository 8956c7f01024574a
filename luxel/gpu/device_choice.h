// The value of --device.
#pragma once

#include "luxel/gpu/device.h"

namespace luxel::gpu {

/// The choice that --device makes.
struct DeviceChoice {
  enum class Kind : uint8_t {
    processor,  ///< "cpu": alone
    device,     ///< "gpu": the first graphics card; "gpu:1": the device of that number, from 0 on,
                ///< of two digits at most; "gpu:TEXT": the first device whose name holds the text
    any,        ///< "auto": a graphics card where there is one
  };
  Kind kind = Kind::processor;
  DeviceParams params;
};

/// Errors (bad_setting): the text is none of these.
Result<DeviceChoice> parse_device(std::string_view text);

struct ChosenDevice {
  std::unique_ptr<Device> device;  ///< null: the processor has it
  /// Why a graphics card that is there is not it, of Kind::any.
  std::string why_none;
};
/// Errors: those of Device::open() for Kind::device.
Result<ChosenDevice> open_chosen(const DeviceChoice& choice);

}  // namespace luxel::gpu
