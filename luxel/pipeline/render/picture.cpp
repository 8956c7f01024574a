#include "luxel/pipeline/render/picture.h"

#include <cstring>

#include "luxel/base/file.h"
#include "luxel/image/color.h"

namespace luxel::pipeline {
namespace {

bool starts_with(std::span<const std::byte> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

/// Display values in [0, 1], decoded; alpha is linear already.
void decode(image::Image& picture) {
  std::vector<float> linear(65536);
  for (size_t v = 0; v < linear.size(); ++v)
    linear[v] = image::linear_from_srgb(float(v) / 65535.0f);
  for (size_t i = 0; i < picture.data.size(); ++i)
    if (i % size_t(picture.channels) != 3)
      picture.data[i] = linear[size_t(picture.data[i] * 65535.0f + 0.5f)];
}

image::Image8 rounded(const image::Image& display) {
  image::Image8 out{display.width, display.height, display.channels, {}};
  out.data.reserve(display.data.size());
  for (const float v : display.data) out.data.push_back(uint8_t(v * 255.0f + 0.5f));
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
    LUXEL_TRY(picture.linear, image::decode_display(bytes, name));
    picture.shown = rounded(picture.linear);
    decode(picture.linear);
  } else {
    return fail(ErrorCode::bad_input,
                "{}: this is not a picture that luxel can read; give an EXR, HDR, PNG or JPEG file",
                name);
  }
  return picture;
}

}  // namespace luxel::pipeline
