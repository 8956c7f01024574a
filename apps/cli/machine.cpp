#include "apps/cli/machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "luxel/base/shown_text.h"
#include "luxel/cluster/mpi.h"
#include "luxel/pipeline/settings/version.h"
#include "luxel/trace/embree/embree_version.h"

namespace luxel::cli {

const char* kind_of(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "graphics card";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated graphics";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual graphics card";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "software on the processor";
    default:
      return "other";
  }
}

std::string compiler() {
#ifdef __clang__
  return "Clang " __clang_version__;
#else
  return "GCC " __VERSION__;
#endif
}

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name"))
      return line.substr(std::min(line.find(':') + 2, line.size()));
  return "unknown";
}

std::string version_text() {
  const std::string mpi = cluster::mpi_version();
  std::string out = fmt::format("luxel {}, {}\ncompiler: {}\nray tracer: Embree {}",
                                pipeline::kVersion, mpi.empty() ? "without MPI" : "with " + mpi,
                                compiler(), trace::embree_version().number);
  const auto devices = gpu::list_devices();
  if (!devices) return out + "\ndevice: none; " + shown_text(devices.error().message);
  for (const gpu::DeviceInfo& d : *devices)
    out += fmt::format("\ndevice: {}, {}{}", shown_text(d.name), kind_of(d.type),
                       d.lacks.empty() ? "" : "; luxel cannot use it: it lacks " + d.lacks);
  return out;
}

}  // namespace luxel::cli
