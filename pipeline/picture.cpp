#include "pipeline/picture.h"

#include <array>
#include <cstring>

#include "base/file.h"
#include "display/tone_map.h"
#include "image/color.h"

namespace luxel::pipeline {
namespace {

bool starts_with(std::span<const std::byte> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

image::Image linear_of(const image::Image8& shown) {
  std::array<float, 256> linear;
  for (size_t v = 0; v < linear.size(); ++v) linear[v] = image::linear_from_srgb(float(v) / 255.0f);
  image::Image out(shown.width, shown.height, shown.channels);
  for (size_t i = 0; i < out.data.size(); ++i) {
    const bool is_alpha = i % size_t(shown.channels) == 3;
    out.data[i] = is_alpha ? float(shown.data[i]) / 255.0f : linear[shown.data[i]];
  }
  return out;
}

}  // namespace

Result<Picture> read_picture(const std::filesystem::path& path) {
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(path));
  Picture picture;
  picture.name = path.string();
  const std::string& name = picture.name;
  if (starts_with(bytes, "\x76\x2f\x31\x01")) {
    LUXEL_TRY(picture.linear, image::decode_exr(bytes, name));
  } else if (starts_with(bytes, "#?")) {
    LUXEL_TRY(picture.linear, image::decode_hdr(bytes, name));
  } else if (starts_with(bytes, "\x89PNG") || starts_with(bytes, "\xff\xd8\xff")) {
    LUXEL_TRY(picture.shown, image::decode_ldr(bytes, name));
    picture.linear = linear_of(picture.shown);
  } else {
    return fail(ErrorCode::bad_input,
                "{}: this is no picture that luxel reads; give an EXR, HDR, PNG or JPEG file",
                name);
  }
  return picture;
}

image::Image8 shown_at(const Picture& picture, float exposure) {
  return picture.hdr() ? display::tone_map(picture.linear, exposure) : picture.shown;
}

}  // namespace luxel::pipeline
