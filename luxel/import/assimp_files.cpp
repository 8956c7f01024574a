#include "luxel/import/assimp_files.h"

#include <assimp/MemoryIOWrapper.h>

#include <cstring>

#include "luxel/import/text_lines.h"

namespace luxel::import {
namespace {

/// A stream that is in `open` as long as it lives.
class Stream : public Assimp::MemoryIOStream {
 public:
  /// `is_owner`: the bytes are an array that this stream deletes.
  Stream(const uint8_t* bytes, size_t size, bool is_owner, std::set<Assimp::IOStream*>& open)
      : MemoryIOStream(bytes, size, is_owner), open_(open) {
    open_.insert(this);
  }
  ~Stream() override { open_.erase(this); }

 private:
  std::set<Assimp::IOStream*>& open_;
};

}  // namespace

std::string path_for_assimp(const SourceFile& source) {
  const bool is_named_so = lower_case(source.path.extension().string()) == source.extension;
  return source.path.string() + (is_named_so ? "" : source.extension);
}

std::string FilesForAssimp::stated(const char* file) const {
  const std::filesystem::path relative =
      std::filesystem::path(file).lexically_relative(source_.path.parent_path());
  return relative.empty() ? file : relative.string();
}

bool FilesForAssimp::Exists(const char* file) const {
  if (own_ == file) return true;
  return find_named_file(source_.files, stated(file), source_.name).has_value();
}

Assimp::IOStream* FilesForAssimp::Open(const char* file, const char* mode) {
  if (std::strchr(mode, 'w') != nullptr || std::strchr(mode, 'a') != nullptr) return nullptr;
  const auto stream_over = [&](const auto& bytes) {
    return new Stream(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), false, open_);
  };
  if (own_ == file) return text_ ? stream_over(*text_) : stream_over(source_.bytes);
  const auto bytes = read_named_file(source_.files, stated(file), source_.name, source_.memory);
  if (!bytes) return nullptr;
  auto* copy = new uint8_t[bytes->size()];
  if (!bytes->empty()) std::memcpy(copy, bytes->data(), bytes->size());
  return new Stream(copy, bytes->size(), true, open_);
}

FilesForAssimp::~FilesForAssimp() {
  while (!open_.empty()) delete *open_.begin();
}

void FilesForAssimp::Close(Assimp::IOStream* stream) { delete stream; }

}  // namespace luxel::import
