#include "luxel/solve/matrix/patch_locator.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "luxel/base/random.h"
#include "luxel/transport/covers.h"

namespace luxel::matrix {
namespace {

constexpr int kAxisBits = 21;
constexpr uint64_t kAxisMask = (uint64_t(1) << kAxisBits) - 1;
/// Slots of voxels that lie side by side along x share a line of the cache.
constexpr size_t kSlotsPerLine = 4;
/// Two places look for each other from so far above their surfaces, in voxels: over the unevenness
/// of a surface, not over a wall.
constexpr float kLift = 0.05f;

/// A place so far above its surface; half as far as the surface above it, where that is nearer. In
/// a wedge behind a wall that stands askew, the lifted place would lie on the wall's other side.
Vec3 lifted(const trace::RayTracer& tracer, const PatchPoint& p, float voxel_m) {
  const float lift_m = kLift * voxel_m;
  // From a thousandth of that, so that the place's own surface is not met.
  const Vec3 from = p.position + p.normal * (1e-3f * lift_m);
  const trace::Hit above = tracer.closest_hit({from, 0, p.normal, lift_m});
  return p.position + p.normal * (above.found() ? above.t / 2 : lift_m);
}

/// Calls visit(voxel) for all voxels within `reach` steps, in a fixed order, the middle first.
template <class Visit>
void around(uint64_t voxel, int reach, const Visit& visit) {
  visit(voxel);
  const auto axis = [&](int k) { return int64_t(voxel >> (k * kAxisBits) & kAxisMask); };
  for (int64_t dz = -reach; dz <= reach; ++dz)
    for (int64_t dy = -reach; dy <= reach; ++dy)
      for (int64_t dx = -reach; dx <= reach; ++dx) {
        const int64_t x = axis(0) + dx, y = axis(1) + dy, z = axis(2) + dz;
        if ((dx == 0 && dy == 0 && dz == 0) || std::min({x, y, z}) < 0 ||
            std::max({x, y, z}) > int64_t(kAxisMask))
          continue;
        visit(uint64_t(x) | uint64_t(y) << kAxisBits | uint64_t(z) << (2 * kAxisBits));
      }
}

}  // namespace

uint64_t voxel_of(const VoxelGrid& grid, Vec3 position) {
  uint64_t voxel = 0;
  for (int k = 0; k < 3; ++k) {
    const float at = std::floor((position[k] - grid.origin[k]) / grid.voxel_m);
    voxel |= uint64_t(std::clamp(at, 0.0f, float(kAxisMask))) << (k * kAxisBits);
  }
  return voxel;
}

float open_share(const trace::RayTracer& tracer, const PatchPoint& p, const VoxelGrid& grid) {
  return transport::open_share(tracer, p.position, p.normal, grid.cover_m);
}

bool see_each_other(const trace::RayTracer& tracer, const PatchPoint& a, const PatchPoint& b,
                    float voxel_m) {
  const Vec3 from = lifted(tracer, a, voxel_m), to = lifted(tracer, b, voxel_m);
  if (dot(to - from, to - from) <= 1e-12f * voxel_m * voxel_m) return true;
  const trace::Ray ray{from, 0, to - from, 1};
  uint8_t blocked = 0;
  tracer.occluded({&ray, 1}, {&blocked, 1});
  return blocked == 0;
}

PatchLocator::PatchLocator(const VoxelGrid& grid, std::span<const uint64_t> voxel,
                           std::vector<Part> parts)
    : grid_(grid), parts_(std::move(parts)) {
  size_t voxels = 0;
  for (size_t k = 0; k < voxel.size(); ++k) voxels += k == 0 || voxel[k] != voxel[k - 1];
  slots_.resize(std::bit_ceil(2 * voxels + kSlotsPerLine));
  for (uint32_t k = 0; k < voxel.size(); ++k) {
    Slot& slot = slots_[slot_of(voxel[k])];
    if (slot.count == 0) slot = {voxel[k], k, 0};
    ++slot.count;
  }
}

size_t PatchLocator::slot_of(uint64_t voxel) const {
  const size_t mask = slots_.size() - 1;
  size_t at = (hash64(voxel / kSlotsPerLine) * kSlotsPerLine + voxel % kSlotsPerLine) & mask;
  while (slots_[at].count > 0 && slots_[at].voxel != voxel) at = (at + 1) & mask;
  return at;
}

std::span<const PatchLocator::Part> PatchLocator::parts_in(uint64_t voxel) const {
  if (slots_.empty()) return {};
  const Slot& slot = slots_[slot_of(voxel)];
  return std::span(parts_).subspan(slot.first, slot.count);
}

const PatchLocator::Part* PatchLocator::part_at(const PatchPoint& at, uint32_t material,
                                                std::span<const Part> parts,
                                                const trace::RayTracer& tracer) const {
  const auto fits = [&](const Part& part) {
    return part.material == material && dot(part.seed.normal, at.normal) > kSameDirection &&
           part.patch != kNone;
  };
  const Part* only = nullptr;
  int count = 0;
  for (const Part& part : parts)
    if (fits(part)) only = &part, ++count;
  if (count == 1) return only;
  if (count > 1)
    for (const Part& part : parts)
      if (fits(part) && see_each_other(tracer, at, part.seed, grid_.voxel_m)) return &part;
  // No point of the voxel's own: the nearest of what is alike around, else of what faces the same
  // way at all.
  for (const bool strict : {true, false}) {
    const Part* nearest = nullptr;
    float least = INFINITY;
    around(voxel_of(grid_, at.position), 1, [&](uint64_t voxel) {
      for (const Part& part : parts_in(voxel)) {
        const Vec3 d = part.seed.position - at.position;
        const bool alike =
            strict ? fits(part) : dot(part.seed.normal, at.normal) > 0 && part.patch != kNone;
        if (alike && dot(d, d) < least) least = dot(d, d), nearest = &part;
      }
    });
    if (nearest) return nearest;
  }
  return nullptr;
}

/// Rays ask only where the place's voxel has covered parts of its kind.
bool PatchLocator::is_covered_at(const PatchPoint& at, uint32_t material,
                                 std::span<const Part> parts,
                                 const trace::RayTracer& tracer) const {
  const bool maybe = std::any_of(parts.begin(), parts.end(), [&](const Part& part) {
    return part.covered && part.material == material &&
           dot(part.seed.normal, at.normal) > kSameDirection;
  });
  return maybe && is_covered(tracer, at, grid_);
}

uint32_t PatchLocator::locate(Vec3 position, Vec3 normal, uint32_t material,
                              const trace::RayTracer& tracer) const {
  const PatchPoint at{position, normal};
  const std::span<const Part> parts = parts_in(voxel_of(grid_, position));
  if (is_covered_at(at, material, parts, tracer)) return kNone;
  const Part* part = part_at(at, material, parts, tracer);
  return part ? part->patch : kNone;
}

void PatchLocator::near(Vec3 position, int reach, std::vector<uint32_t>& patches) const {
  patches.clear();
  around(voxel_of(grid_, position), reach, [&](uint64_t at) {
    for (const Part& part : parts_in(at))
      if (part.patch != kNone) patches.push_back(part.patch);
  });
  std::sort(patches.begin(), patches.end());
  patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
}

}  // namespace luxel::matrix
