// Hemicubes on a graphics device. [Cohen85; Rodriguez06, 6.7]
#pragma once

#include <memory>

#include "luxel/gpu/device.h"
#include "luxel/solve/hemicube/look_device.h"

namespace luxel::device {

/// `device` is kept by reference and must outlive it. It knows no textured emission that pixels
/// see.
std::unique_ptr<hemicube::LookDevice> look_device(const gpu::Device& device);

}  // namespace luxel::device
