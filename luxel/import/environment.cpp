#include "luxel/import/environment.h"

#include <new>

#include "luxel/image/codec.h"
#include "luxel/import/reading_memory.h"

namespace luxel::import {
namespace {

Result<image::Image> decode(const std::filesystem::path& file, ReadingMemory& memory) {
  const std::string extension = file.extension().string();
  LUXEL_TRY(const std::vector<std::byte> bytes, read_counted(file, memory));
  if (extension == ".hdr" || extension == ".HDR") return image::decode_hdr(bytes, file.string());
  if (extension == ".exr" || extension == ".EXR") return image::decode_exr(bytes, file.string());
  return fail(ErrorCode::bad_input,
              "{}: an environment is an .hdr or .exr picture, not {}; 8-bit pictures do not hold "
              "the light of a sky",
              file.string(), extension.empty() ? "a file without ending" : extension);
}

}  // namespace

Result<ImportedEnvironment> environment_from(const image::Image& picture, const std::string& name,
                                             float rotation_rad, float scale) {
  if (picture.width != 2 * picture.height || picture.height == 0)
    return fail(ErrorCode::bad_input,
                "{}: {} x {} pixels; an equirectangular environment is twice as wide as high", name,
                picture.width, picture.height);
  ImportedEnvironment out;
  out.map.width = picture.width, out.map.height = picture.height;
  out.map.rotation_rad = rotation_rad;
  out.map.radiance.reserve(size_t(picture.width) * size_t(picture.height));
  size_t negative = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const Rgb l = picture.rgb(x, y) * scale;
      if (!is_finite(l))
        return fail(ErrorCode::bad_input,
                    "{}: pixel ({}, {}) is {}, {}, {}, which is not a radiance", name, x, y, l.x,
                    l.y, l.z);
      if (l.x < 0 || l.y < 0 || l.z < 0) ++negative;
      out.map.radiance.push_back(max(l, Rgb{}));
    }
  if (negative > 0)
    out.warnings.push_back(fmt::format("{}: {} pixels are negative; set to 0", name, negative));
  return out;
}

Result<ImportedEnvironment> read_environment(const std::filesystem::path& file, float rotation_rad,
                                             float scale, uint64_t max_memory_bytes) {
  ReadingMemory memory(max_memory_bytes);
  try {
    const Result<image::Image> picture = decode(file, memory);
    if (picture) return environment_from(*picture, file.string(), rotation_rad, scale);
    if (says_no_memory(picture.error())) return memory.used_up(file.string());
    return Failure{picture.error()};
  } catch (const std::bad_alloc&) {
    return memory.used_up(file.string());
  }
}

}  // namespace luxel::import
