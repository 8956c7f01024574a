#include "luxel/trace/vulkan/device_pictures.h"

#include <cstring>

#include "luxel/image/color.h"

namespace luxel::trace {

on_device::Picture DevicePictures::picture(const scene::TextureRef& ref) {
  if (ref.texture == scene::kNone) return {};
  const scene::Texture& t = scene_.textures[ref.texture];
  uint32_t& first = first_[ref.texture];
  if (first == scene::kNone) {
    first = uint32_t(texels_.size());
    texels_.resize(texels_.size() + t.rgba.size() / 4);
    std::memcpy(texels_.data() + first, t.rgba.data(), t.rgba.size() / 4 * 4);
  }
  return {first,
          uint32_t(t.width),
          uint32_t(t.height),
          uint32_t(ref.wrap_u),
          uint32_t(ref.wrap_v),
          uint32_t(ref.filter == scene::Filter::nearest)};
}

on_device::PlacedPicture DevicePictures::placed(const scene::Mesh& mesh, uint32_t triangle,
                                                const scene::TextureRef& ref) {
  return {picture(ref), !texture_coordinates(mesh, ref).empty(),
          places_in_picture(mesh, triangle, ref)};
}

std::array<float, 256> linear_of_bytes() {
  std::array<float, 256> out;
  for (size_t k = 0; k < out.size(); ++k) out[k] = image::linear_from_srgb(float(k) / 255.0f);
  return out;
}

const std::vector<Vec2>& texture_coordinates(const scene::Mesh& mesh,
                                             const scene::TextureRef& ref) {
  return ref.uv_set == 1 ? mesh.uv1 : mesh.uv0;
}

std::array<Vec2, 3> places_in_picture(const scene::Mesh& mesh, uint32_t triangle,
                                      const scene::TextureRef& ref) {
  const std::vector<Vec2>& uv = texture_coordinates(mesh, ref);
  std::array<Vec2, 3> out{};
  if (uv.empty()) return out;
  for (size_t k = 0; k < 3; ++k)
    out[k] = scene::transformed_uv(ref, uv[mesh.triangles[triangle][k]]);
  return out;
}

}  // namespace luxel::trace
