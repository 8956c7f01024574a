// Facts about this program and the machine that it runs on.
#pragma once

#include <string>

#include "luxel/gpu/device.h"

namespace luxel::cli {

/// "graphics card".
const char* kind_of(VkPhysicalDeviceType type);
/// "GCC 12.2.0".
std::string compiler();
/// "AMD EPYC 7B13".
std::string processor();
/// Output of --version: luxel, compiler, libraries and devices, a line each.
std::string version_text();

}  // namespace luxel::cli
