// Which hierarchy a device traces rays by.
#pragma once

#include "luxel/gpu/device.h"
#include "luxel/trace/vulkan/device_hierarchy.h"

namespace luxel::trace {

/// Luxel's own hierarchy in the form that was faster where `luxel bench gpu` was run: wide on a
/// processor that plays a device, binary on a data-centre GPU (docs/method/gpu.md).
HierarchyKind own_hierarchy(const gpu::Device& device);

/// Rays per second that a device traces by one kind.
struct HierarchyRate {
  HierarchyKind kind;
  double rays_per_s;
};
/// own_hierarchy() and, where the device has ray queries, the driver's, by so many rays in a scene
/// of 82,000 triangles. Errors: no memory, the device is lost.
Result<std::vector<HierarchyRate>> measure_hierarchies(const gpu::Device& device, size_t rays);

/// The kind for scenes on this device. The driver's is taken where it has been measured now to be
/// clearly faster, and never where a processor plays the device or the measurement fails.
HierarchyKind faster_hierarchy(const gpu::Device& device);
/// The rule: `measured` has luxel's own first, then the driver's if there is one.
HierarchyKind faster_of(const std::vector<HierarchyRate>& measured);

}  // namespace luxel::trace
