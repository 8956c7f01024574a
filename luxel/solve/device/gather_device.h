// Gather's rays on a graphics device, as gather asks for them.
#pragma once

#include <memory>

#include "luxel/gpu/device.h"
#include "luxel/solve/gather/rays/ray_device.h"

namespace luxel::device {

/// `device` is kept by reference and must outlive it.
std::unique_ptr<gather::RayDevice> gather_device(const gpu::Device& device);

}  // namespace luxel::device
