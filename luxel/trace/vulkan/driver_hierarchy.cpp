#include "luxel/trace/vulkan/driver_hierarchy.h"

#include <algorithm>
#include <bit>

#include "luxel/trace/vulkan/stored_triangles.h"

namespace luxel::trace {
namespace {

constexpr std::string_view kWhat = "the driver's boxes around triangles";
/// Each is an allocation of its own, of which drivers give some 4000.
constexpr size_t kMostParts = 1000;
constexpr size_t kMostPlaces = (size_t(1) << 24) - 1;  // instanceCustomIndex has 24 bits

Vec3 centre(const DeviceTriangle& t) { return (t.a + t.b + t.c) * (1.0f / 3); }

/// Sorts triangles into halves until none has more than `most`, by their centres along the longest
/// axis; calls at_part(first, last) for each.
template <class AtPart>
void halve(std::span<DeviceTriangle> some, size_t most, const AtPart& at_part) {
  if (some.size() <= most) return at_part(some);
  Box3 box;
  for (const DeviceTriangle& t : some) box.extend(centre(t));
  const Vec3 size = box.upper - box.lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const size_t half = some.size() / 2;
  std::nth_element(some.begin(), some.begin() + ptrdiff_t(half), some.end(),
                   [&](const DeviceTriangle& a, const DeviceTriangle& b) {
                     const float x = centre(a)[axis], y = centre(b)[axis];
                     return x != y ? x < y : a.number < b.number;
                   });
  halve(some.first(half), most, at_part);
  halve(some.subspan(half), most, at_part);
}

/// Appends triangles in parts. Returns how many parts there are.
uint32_t add_parts(std::vector<DeviceTriangle> some, size_t most, DriverHierarchy& out) {
  uint32_t parts = 0;
  halve(some, most, [&](std::span<DeviceTriangle> part) {
    if (part.empty()) return;
    const auto open = std::stable_partition(
        part.begin(), part.end(), [](const DeviceTriangle& t) { return t.see_through == 0; });
    const auto first = uint32_t(out.triangles.size());
    out.triangles.insert(out.triangles.end(), part.begin(), part.end());
    out.parts.push_back(
        {first, first + uint32_t(open - part.begin()), uint32_t(out.triangles.size())});
    ++parts;
  });
  return parts;
}

gpu::Placed placed(uint32_t part, uint32_t place, const Mat34& world_from_object) {
  gpu::Placed out{};
  for (size_t row = 0; row < 3; ++row)
    for (size_t k = 0; k < 4; ++k) out.transform.matrix[row][k] = world_from_object.row[row][k];
  out.instanceCustomIndex = place;
  out.mask = 0xff;
  out.accelerationStructureReference = part;
  return out;
}

}  // namespace

Result<DriverHierarchy> driver_hierarchy(const scene::Scene& scene, size_t max_flat_triangles,
                                         size_t most_in_part) {
  LUXEL_TRY(StoredTriangles stored, stored_triangles(scene, max_flat_triangles));
  DriverHierarchy out;
  out.see_through = std::move(stored.see_through);
  out.has_instances = !stored.shared.empty();
  const std::vector<uint32_t> first = scene::first_triangles(scene);
  std::vector<DriverInstance> instances;
  // Triangles are counted from behind the instances, whose number is not known yet.
  const auto place = [&](uint32_t part, uint32_t first_number, uint32_t instance,
                         const Mat34& world_from_object) {
    const DriverPart& p = out.parts[part];
    out.places.push_back(placed(part, uint32_t(instances.size()), world_from_object));
    instances.push_back({p.first, p.first_open, first_number, instance});
  };
  const uint32_t in_world = add_parts(std::move(stored.in_world), most_in_part, out);
  for (uint32_t part = 0; part < in_world; ++part) place(part, 0, scene::kNone, {});
  for (SharedMesh& mesh : stored.shared) {
    const auto first_part = uint32_t(out.parts.size());
    const uint32_t parts = add_parts(std::move(mesh.triangles), most_in_part, out);
    for (const uint32_t i : mesh.instances)
      for (uint32_t k = 0; k < parts; ++k)
        place(first_part + k, first[i], i, scene.instances[i].world_from_object);
  }
  if (instances.size() > kMostPlaces)
    return fail(ErrorCode::unsupported, "drivers take at most {} instances, not {}", kMostPlaces,
                instances.size());
  const auto behind = uint32_t(instances.size());
  for (DriverInstance& i : instances) i.first += behind, i.first_open += behind;
  for (DriverPart& p : out.parts) p.first += behind, p.first_open += behind, p.end += behind;
  out.triangles.insert(out.triangles.begin(), instances.size(), {});
  std::ranges::transform(instances, out.triangles.begin(),
                         [](const DriverInstance& i) { return std::bit_cast<DeviceTriangle>(i); });
  return out;
}

Result<DriverAcceleration> accelerate(gpu::Commands& commands, const DriverHierarchy& hierarchy,
                                      const gpu::Buffer& triangles) {
  // A corner and the number beside it.
  constexpr uint32_t kCornerBytes = sizeof(DeviceTriangle) / 3;
  const auto geometry = [&](uint32_t first, uint32_t end, bool are_opaque) {
    // Also where there are none, the address is one of the buffer.
    const VkDeviceSize offset = first < end ? first * sizeof(DeviceTriangle) : 0;
    return gpu::AcceleratedTriangles{triangles.address + offset, end - first, kCornerBytes,
                                     are_opaque};
  };
  if (hierarchy.parts.size() > kMostParts)
    return fail(ErrorCode::unsupported, "drivers take at most {} meshes, not {}", kMostParts,
                hierarchy.parts.size());
  DriverAcceleration out;
  for (const DriverPart& p : hierarchy.parts) {
    const gpu::AcceleratedTriangles both[] = {geometry(p.first, p.first_open, true),
                                              geometry(p.first_open, p.end, false)};
    LUXEL_TRY(out.parts.emplace_back(), gpu::accelerate(commands, both, kWhat));
  }
  std::vector<gpu::Placed> places = hierarchy.places;
  for (gpu::Placed& p : places)
    p.accelerationStructureReference = out.parts[p.accelerationStructureReference].address;
  LUXEL_TRY(out.world, gpu::accelerate(commands, places, kWhat));
  return out;
}

}  // namespace luxel::trace
