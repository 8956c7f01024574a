// Reading the pictures that the program leaves.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "luxel/base/file.h"
#include "luxel/image/codec.h"
#include "luxel/image/color.h"

namespace luxel::testing_support {

/// The file's picture; where there is none the test has failed, and one black pixel goes on.
inline image::Image exr_at(const std::filesystem::path& file) {
  const auto bytes = read_file(file);
  EXPECT_TRUE(bytes) << file;
  if (!bytes) return {1, 1, 4};
  auto picture = image::decode_exr(*bytes, file.string());
  EXPECT_TRUE(picture) << file;
  return picture ? std::move(*picture) : image::Image(1, 1, 4);
}

/// A picture's display values as linear light, 3 channels; as exr_at() where there is none.
inline image::Image png_at(const std::filesystem::path& file) {
  const auto bytes = read_file(file);
  EXPECT_TRUE(bytes) << file;
  if (!bytes) return {1, 1, 3};
  const auto picture = image::decode_display(*bytes, file.string());
  EXPECT_TRUE(picture) << file;
  if (!picture) return {1, 1, 3};
  image::Image linear(picture->width, picture->height, 3);
  for (int y = 0; y < linear.height; ++y)
    for (int x = 0; x < linear.width; ++x) {
      const Rgb c = picture->rgb(x, y);
      linear.set_rgb(x, y,
                     {image::linear_from_srgb(c.x), image::linear_from_srgb(c.y),
                      image::linear_from_srgb(c.z)});
    }
  return linear;
}

/// The lightmap that a bake has left in a folder.
inline image::Image lightmap_of(const std::filesystem::path& folder) {
  return exr_at(folder / "lightmap.exr");
}

}  // namespace luxel::testing_support
