#include "luxel/import/gltf_images.h"

#include <charconv>
#include <cstring>

#include "luxel/base/base64.h"

namespace luxel::import {
namespace {

using Json = nlohmann::json;

bool is_data(const std::string& uri) { return uri.starts_with("data:"); }

/// Empty where it is none.
std::string text_in(const Json& image, const char* key) {
  const auto text = image.find(key);
  return text == image.end() || !text->is_string() ? "" : text->get<std::string>();
}

/// A key that images with the same bytes share.
std::string place_of(const Json& image, size_t index) {
  if (image.contains("bufferView")) return fmt::format("view {}", image["bufferView"].dump());
  const std::string uri = text_in(image, "uri");
  return is_data(uri) ? fmt::format("image {}", index) : "file " + decoded_uri(uri);
}

std::vector<std::byte> bytes_of(const unsigned char* first, size_t count) {
  std::vector<std::byte> out(count);
  if (count > 0) std::memcpy(out.data(), first, count);
  return out;
}

}  // namespace

std::string decoded_uri(std::string_view uri) {
  std::string out;
  for (size_t i = 0; i < uri.size(); ++i) {
    unsigned value = 0;
    const char* const digits = uri.data() + i + 1;
    if (uri[i] == '%' && i + 2 < uri.size() &&
        std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      out += char(value), i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

Result<std::vector<std::byte>> encoded_image(const GltfReader& reader, size_t index,
                                             const std::string& what) {
  const Json& image = reader.document["images"][index];
  if (image.contains("bufferView")) {
    const auto& view = reader.model.bufferViews[image["bufferView"].get<size_t>()];
    const auto& buffer = reader.model.buffers[size_t(view.buffer)].data;
    // A buffer that nothing but pictures uses may have been left out (placeholder_buffers()).
    if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset)
      return fail(ErrorCode::bad_input, "{} lies beyond the end of its buffer", what);
    return bytes_of(buffer.data() + view.byteOffset, view.byteLength);
  }
  const std::string uri = text_in(image, "uri");
  if (uri.empty()) return fail(ErrorCode::bad_input, "{} has neither a uri nor a bufferView", what);
  if (!is_data(uri))
    return read_named_picture(reader.source.files, decoded_uri(uri), what, reader.source.memory);
  constexpr std::string_view kMark = ";base64,";
  const size_t mark = uri.find(kMark);
  auto bytes = mark == uri.npos ? std::nullopt
                                : from_base64(std::string_view(uri).substr(mark + kMark.size()));
  if (!bytes)
    return fail(ErrorCode::bad_input, "{} is a data URI that is no base64; export it again", what);
  return *std::move(bytes);
}

Result<uint32_t> load_image(const GltfReader& reader, Pictures& pictures, int image_index,
                            const std::string& user, std::string_view instead) {
  const size_t index = size_t(image_index);
  const Json& image = reader.document["images"][index];
  const auto load = [&]() -> Result<scene::Texture> {
    const std::string uri = text_in(image, "uri"), name = text_in(image, "name");
    const std::string file = uri.empty() || is_data(uri) ? label("image", index, name) : uri;
    const std::string where = reader.source.name + ": " + file;
    LUXEL_TRY(std::vector<std::byte> encoded,
              encoded_image(reader, index,
                            fmt::format("{}: the texture of {}", reader.source.name, user)));
    if (encoded.empty())
      return fail(ErrorCode::bad_input, "{}: the texture of {} is empty", where, user);
    LUXEL_TRY(scene::Texture texture,
              decode_texture(std::move(encoded), where, user, reader.source.memory));
    texture.name = name.empty() ? file : name;
    return texture;
  };
  return picture_of(pictures, place_of(image, index), instead, load);
}

}  // namespace luxel::import
