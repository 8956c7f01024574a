// The folder of shared data, and skipping tests where it is not there.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace luxel::testing_support {

/// The folder of shared data: $LUXEL_SHARED, or `shared` beside the repository. A user's machine
/// has none: tests that need it say so and are skipped.
inline std::filesystem::path shared_folder() {
  if (const char* folder = std::getenv("LUXEL_SHARED")) return folder;
  return std::filesystem::path(LUXEL_SOURCE_DIR).parent_path() / "shared";
}

}  // namespace luxel::testing_support

/// Skips the running test, with the reason, when shared/FILE is not there.
#define LUXEL_NEEDS_SHARED(file)                                                            \
  if (!std::filesystem::exists(::luxel::testing_support::shared_folder() / (file)))         \
  GTEST_SKIP() << "needs " << (::luxel::testing_support::shared_folder() / (file)).string() \
               << ", which is not on this machine"
