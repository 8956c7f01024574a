// Where a bake's files go: tried out before the work, made when it is done.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"

namespace luxel {

/// The stage of Progress in which files appear. It is short and better not cut off.
inline constexpr std::string_view kWriteStage = "write files";

/// `folder`, or the nearest folder above it that exists. Temporary files without a name go there.
std::filesystem::path nearest_folder(const std::filesystem::path& folder);

/// An error, before the work, when the file `file` could not be written after it: its folder is
/// missing (bad_setting) or cannot be written to (io), or a folder or a device has its name
/// (bad_setting).
Status check_output_file(const std::filesystem::path& file);

/// A folder for results. What make() made goes again, unless keep() is called: work that fails or
/// is cancelled leaves nothing, not even an empty folder.
class OutputFolder {
 public:
  explicit OutputFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  /// Errors when the folder cannot be made or written to. Leaves it as it was.
  Status try_out();
  Status make();
  /// make(), and nobody else may hold it until this object or the process is gone. When the process
  /// is ended by someone who asks `progress` what to do first, or this object goes, what make()
  /// made goes too, if it is still empty; only a kill leaves an empty folder. Errors, besides those
  /// of try_out(): somebody holds it.
  Status hold(Progress& progress);
  void keep() { made_.clear(); }

 private:
  Status lock();
  Status write_probe() const;
  void remove_made();

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  ///< the innermost first
  int lock_ = -1;                            ///< the folder, opened
};

}  // namespace luxel
