// Textures of a scene as devices look them up.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "luxel/scene/scene.h"

namespace luxel::trace {

/// A texture in a list of texels, and how it is looked up.
struct DevicePicture {
  uint32_t first = 0;
  uint32_t width = 0, height = 0;   ///< 0: none, which is 1 everywhere
  uint32_t wrap_u = 0, wrap_v = 0;  ///< scene::Wrap
  uint32_t nearest = 0;             ///< 1: not filtered
};

/// A picture on a triangle.
struct PlacedPicture {
  DevicePicture picture;
  uint32_t is_placed = 0;        ///< whether its mesh has texture coordinates
  std::array<Vec2, 3> places{};  ///< of the triangle's corners in the picture
};
static_assert(sizeof(PlacedPicture) == 52);

/// Puts each texture into a list of texels once. What it is made with must outlive it.
class DevicePictures {
 public:
  /// `texels`: RGBA, red in the lowest byte.
  DevicePictures(const scene::Scene& scene, std::vector<uint32_t>& texels)
      : scene_(scene), texels_(texels), first_(scene.textures.size(), scene::kNone) {}

  /// Where the texture lies; of no texture: a picture of no size.
  DevicePicture picture(const scene::TextureRef& ref);
  /// As a triangle of a mesh has it.
  PlacedPicture placed(const scene::Mesh& mesh, uint32_t triangle, const scene::TextureRef& ref);

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
