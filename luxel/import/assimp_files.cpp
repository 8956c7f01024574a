#include "luxel/import/assimp_files.h"

#include <assimp/MemoryIOWrapper.h>

#include <cstring>
#include <span>

namespace luxel::import {
namespace {

/// A stream over bytes that outlive it.
Assimp::IOStream* stream_over(std::span<const std::byte> bytes) {
  return new Assimp::MemoryIOStream(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
}

/// A stream with bytes of its own.
Assimp::IOStream* stream_with(std::span<const std::byte> bytes) {
  auto* copy = new uint8_t[bytes.size()];
  if (!bytes.empty()) std::memcpy(copy, bytes.data(), bytes.size());
  return new Assimp::MemoryIOStream(copy, bytes.size(), true);
}

}  // namespace

std::string FilesForAssimp::stated(const char* file) const {
  const std::filesystem::path relative =
      std::filesystem::path(file).lexically_relative(source_.path.parent_path());
  return relative.empty() ? file : relative.string();
}

bool FilesForAssimp::Exists(const char* file) const {
  if (source_.path == file || texts_.contains(file)) return true;
  return others_ && find_named_file(source_.files, stated(file), source_.name).has_value();
}

Assimp::IOStream* FilesForAssimp::Open(const char* file, const char* mode) {
  if (std::strchr(mode, 'w') != nullptr || std::strchr(mode, 'a') != nullptr) return nullptr;
  if (const auto text = texts_.find(file); text != texts_.end())
    return stream_over(std::as_bytes(std::span(text->second)));
  if (source_.path == file) return stream_over(source_.bytes);
  if (!others_) return nullptr;
  const auto bytes = read_named_file(source_.files, stated(file), source_.name, source_.memory);
  return bytes ? stream_with(*bytes) : nullptr;
}

void FilesForAssimp::Close(Assimp::IOStream* stream) { delete stream; }

}  // namespace luxel::import
