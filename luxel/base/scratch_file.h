// A temporary file without a name: gone with its owner, however the program ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "luxel/base/result.h"

namespace luxel {

class ScratchFile {
 public:
  /// Errors: no file can be made there.
  static Result<ScratchFile> create(const std::filesystem::path& folder);
  ScratchFile(ScratchFile&& other) noexcept;
  ScratchFile& operator=(ScratchFile&& other) noexcept;
  ~ScratchFile();

  /// Thread-safe for ranges that do not overlap. Places never written take no space. Errors: the
  /// disk is full.
  Status write(uint64_t offset, const void* bytes, size_t count) const;
  Status read(uint64_t offset, void* bytes, size_t count) const;
  /// Takes this much of the disk at once. Errors: it has not so much.
  Status reserve(uint64_t bytes) const;
  /// Addresses at which the first bytes of the file are read and written, until munmap(). Errors:
  /// none are left.
  Result<void*> map(uint64_t bytes) const;

 private:
  ScratchFile(std::filesystem::path folder, int file);
  std::filesystem::path folder_;
  int file_ = -1;
};

}  // namespace luxel
