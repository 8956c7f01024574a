// Surfaces that let light through, as devices know them: masks, blended and transmissive ones.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec.h"
#include "luxel/trace/vulkan/binary_hierarchy.h"
#include "luxel/trace/vulkan/device_pictures.h"

namespace luxel::trace {

/// scene::Material without what rays do not notice.
struct SeeThroughMaterial {
  uint32_t mode = 0;  ///< scene::AlphaMode
  float alpha = 1, cutoff = 0.5f, transmission = 0, metallic = 0;
  DevicePicture base, metal, glass;
};
static_assert(sizeof(SeeThroughMaterial) == 92);

/// A triangle of such a material. Places in its pictures are already transformed. `instance` is
/// that of a triangle of the world; one of a shared mesh has many.
struct SeeThroughTriangle {
  uint32_t instance = 0, triangle = 0;
  uint32_t material = 0;  ///< into SeeThrough::materials
  uint32_t placed = 0;    ///< bits 0 to 2: whether the mesh has coordinates for base, metal, glass
  std::array<Vec2, 3> base, metal, glass;
  std::array<float, 3> alpha;  ///< of its corners
};
static_assert(sizeof(SeeThroughTriangle) == 100);

struct SeeThrough {
  std::vector<SeeThroughMaterial> materials;
  std::vector<SeeThroughTriangle> triangles;
  std::vector<uint32_t> texels;  ///< RGBA, red in the lowest byte
};

/// Finds surfaces that let light through. What it is made with must outlive it.
class SeeThroughFinder {
 public:
  SeeThroughFinder(const scene::Scene& scene, SeeThrough& out);
  /// Adds those among `triangles`, which have the numbers of drawn ones, and notes in each where it
  /// is found: DeviceTriangle::see_through.
  void find(std::span<DeviceTriangle> triangles);

 private:
  const scene::Scene& scene_;
  SeeThrough& out_;
  DevicePictures pictures_;
  bool any_;  ///< whether any material lets light through
  std::vector<uint32_t> first_triangle_;
  std::vector<uint32_t> material_there_;  ///< per material: its number in out_
};

}  // namespace luxel::trace
