#include "luxel/import/pictures.h"

#include "luxel/image/codec.h"

namespace luxel::import {

Result<scene::Texture> decode_texture(std::vector<std::byte> encoded, const std::string& name,
                                      const std::string& user, ReadingMemory& memory) {
  const auto allow = [&](uint32_t width, uint32_t height) {
    return memory.take(uint64_t(4) * width * height,
                       fmt::format("{}, a picture of {} x {} pixels", name, width, height));
  };
  auto image = image::decode_ldr(encoded, name, allow);
  if (!image) return fail(image.error().code, "{} (texture of {})", image.error().message, user);
  scene::Texture texture;
  texture.name = name;
  texture.width = image->width;
  texture.height = image->height;
  texture.rgba = std::move(image->data);
  const auto begins = [&](uint8_t byte) { return encoded[0] == std::byte{byte}; };
  texture.mime_type = begins(0x89)   ? "image/png"
                      : begins('R')  ? "image/webp"
                      : begins(0xff) ? "image/jpeg"
                                     : "";
  // glTF holds no BMP and no TGA: they go on as pixels.
  if (!texture.mime_type.empty()) texture.encoded = std::move(encoded);
  return texture;
}

Result<scene::Texture> load_picture(const SourceFile& source, const std::string& name,
                                    const std::string& user) {
  LUXEL_TRY(
      std::vector<std::byte> encoded,
      read_named_picture(source.files, name,
                         fmt::format("{}: the texture of {}", source.name, user), source.memory));
  LUXEL_TRY(scene::Texture texture,
            decode_texture(std::move(encoded), source.name + ": " + name, user, source.memory));
  texture.name = name;
  return texture;
}

}  // namespace luxel::import
