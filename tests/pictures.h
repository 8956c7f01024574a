// Reading the pictures that the program leaves.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "luxel/base/file.h"
#include "luxel/image/codec.h"

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

/// What a bake has left in a folder.
inline image::Image lightmap_of(const std::filesystem::path& folder) {
  return exr_at(folder / "lightmap.exr");
}

}  // namespace luxel::testing_support
