// What the fuzzers' targets share.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "luxel/base/check.h"
#include "luxel/base/result.h"

namespace luxel::fuzz {

inline std::vector<std::byte> copy_of(std::span<const std::byte> bytes) {
  return {bytes.begin(), bytes.end()};
}
inline std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
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

/// A folder of this process, in memory where the machine has such; removed with this object.
class Scratch {
 public:
  Scratch() {
    const bool in_memory = std::filesystem::is_directory("/dev/shm");
    std::string name = in_memory ? "/dev/shm/luxel-fuzz-XXXXXX" : "/tmp/luxel-fuzz-XXXXXX";
    path_ = ::mkdtemp(name.data());
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::ofstream(path_ / name, std::ios::binary)
        .write(bytes.data(), std::streamsize(bytes.size()));
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace luxel::fuzz
