// Files of formats that only Assimp reads, in a process of their own.
#pragma once

#include <cstdint>
#include <filesystem>

#include "luxel/import/import.h"

namespace luxel::import {

/// Limits of the process, which it sets for itself before it opens the file.
struct ProcessLimits {
  double seconds = 0;         ///< of processor time
  uint64_t memory_bytes = 0;  ///< as for import_scene()
};
/// Assimp reads some megabytes a second.
ProcessLimits usual_limits(uint64_t file_bytes, uint64_t max_memory_bytes);

/// Assimp's readers of rare formats trust what they find: they may end their process, never end,
/// or fill the memory. So the program luxel, which lies beside this one, beside this library, or in
/// a folder of PATH, reads the file by import_in_this_process() and hands the scene over as a
/// binary glTF file, which has all but Phong's highlights. The command for that, `luxel
/// import-any`, is hidden. Errors: there is no such program (unsupported); the file's own; how the
/// process ended, if not by itself.
Result<Imported> import_in_other_process(const std::filesystem::path& path,
                                         const ImportParams& params, const ProcessLimits& limits);

/// import_scene() of a file of any format that Assimp knows. For that command alone: what is wrong
/// with a file may end the process.
Result<Imported> import_in_this_process(const std::filesystem::path& path,
                                        const ImportParams& params, uint64_t max_memory_bytes);

}  // namespace luxel::import
