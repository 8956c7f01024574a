// Helpers that the fuzzers' targets share.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "luxel/base/check.h"
#include "luxel/base/result.h"
#include "tests/scratch_folder.h"

namespace luxel::fuzz {

inline std::vector<std::byte> copy_of(std::span<const std::byte> bytes) {
  return {bytes.begin(), bytes.end()};
}
inline std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The low `bytes` bytes of a number, little-endian, at the end.
inline void append_number(std::vector<std::byte>& out, uint64_t value, size_t bytes) {
  for (size_t k = 0; k < bytes; ++k) out.push_back(std::byte(value >> (8 * k)));
}
/// Over what stands at `at`.
inline void put_number(std::span<std::byte> out, size_t at, uint64_t value, size_t bytes) {
  for (size_t k = 0; k < bytes; ++k) out[at + k] = std::byte(value >> (8 * k));
}

/// An error is a sentence of a readable length: no dump of the file, and not empty.
template <class T>
bool is_read(const Result<T>& result) {
  if (result) return true;
  const std::string& message = result.error().message;
  LUXEL_CHECK(!message.empty() && message.size() < 4000);
  LUXEL_CHECK(result.error().code != ErrorCode::cancelled);
  return false;
}

/// A folder in memory, where the machine has such: millions of inputs are written into it.
inline testing_support::ScratchFolder scratch_in_memory() {
  const std::filesystem::path memory = "/dev/shm";
  return testing_support::ScratchFolder(
      std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path());
}

}  // namespace luxel::fuzz
