// Where a bake's files go: tried out before the work, made when it is done.
#pragma once

#include <filesystem>
#include <vector>

#include "base/result.h"

namespace luxel::pipeline {

/// `folder`, or the nearest folder above it that exists. Temporary files without a name go there.
std::filesystem::path nearest_folder(const std::filesystem::path& folder);

/// A folder for results. What make() made goes again, unless keep() is called: work that fails, is
/// cancelled or killed leaves nothing, not even an empty folder.
class OutputFolder {
 public:
  explicit OutputFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder() { remove_made(); }

  /// Errors when the folder cannot be made or written to. Leaves it as it was.
  Status try_out();
  Status make();
  void keep() { made_.clear(); }

 private:
  void remove_made();

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  ///< the innermost first
};

}  // namespace luxel::pipeline
