// Textures of a scene as devices look them up.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "luxel/scene/scene.h"
#include "luxel/trace/vulkan/world_shared.h"

namespace luxel::trace {

/// Puts each texture into a list of texels once. What it is made with must outlive it.
class DevicePictures {
 public:
  /// `texels`: RGBA, red in the lowest byte.
  DevicePictures(const scene::Scene& scene, std::vector<uint32_t>& texels)
      : scene_(scene), texels_(texels), first_(scene.textures.size(), scene::kNone) {}

  /// Where the texture lies; of no texture: a picture of no size.
  on_device::Picture picture(const scene::TextureRef& ref);
  /// As a triangle of a mesh has it.
  on_device::PlacedPicture placed(const scene::Mesh& mesh, uint32_t triangle,
                                  const scene::TextureRef& ref);

 private:
  const scene::Scene& scene_;
  std::vector<uint32_t>& texels_;
  std::vector<uint32_t> first_;  ///< per texture
};

/// The linear value of each byte of an sRGB colour.
std::array<float, 256> linear_of_bytes();

/// The mesh's coordinates for a texture; may be empty.
const std::vector<Vec2>& texture_coordinates(const scene::Mesh& mesh, const scene::TextureRef& ref);

/// Where a triangle's corners lie in a picture, already transformed; zeros without coordinates.
std::array<Vec2, 3> places_in_picture(const scene::Mesh& mesh, uint32_t triangle,
                                      const scene::TextureRef& ref);

}  // namespace luxel::trace
