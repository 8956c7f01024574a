// Bakes with their files, for tables that measure whole ones.
#pragma once

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "luxel/base/file.h"
#include "luxel/image/codec.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {

/// Removes what bakes leave.
struct TemporaryFolder {
  std::filesystem::path path;
  explicit TemporaryFolder(const std::string& name)
      : path(std::filesystem::temp_directory_path() / name) {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
    std::filesystem::create_directories(path, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

struct TimedFiles {
  nlohmann::json report;
  double seconds = INFINITY;
};

/// Bakes into settings.output.
inline Result<TimedFiles> timed_files(const pipeline::BakeSettings& settings) {
  Progress progress;
  const auto start = Clock::now();
  LUXEL_TRY(nlohmann::json report, pipeline::bake(settings, progress));
  return TimedFiles{std::move(report), seconds_since(start)};
}

/// Bakes as above; `best` is the fastest of all so far.
inline Status time_again(const pipeline::BakeSettings& settings, TimedFiles& best) {
  LUXEL_TRY(TimedFiles bake, timed_files(settings));
  if (bake.seconds < best.seconds) best = std::move(bake);
  return {};
}

/// Reads a picture. Errors: no such file, no EXR.
inline Result<image::Image> exr_at(const std::filesystem::path& file) {
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(file));
  return image::decode_exr(bytes, file.string());
}

}  // namespace luxel::bench
