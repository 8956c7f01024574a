// The files that Assimp opens. For the Assimp reader only.
#pragma once

#include <assimp/IOSystem.hpp>

#include <map>
#include <set>
#include <string>

#include "luxel/import/readers.h"

namespace luxel::import {

/// Gives Assimp the scene's file from memory, texts of ours in the place of others, and of all else
/// only what a scene may name (scene_files.h). Nothing is written.
class FilesForAssimp : public Assimp::IOSystem {
 public:
  explicit FilesForAssimp(const SourceFile& source) : source_(source) {}
  /// Closes what Assimp has left open where it met an error.
  ~FilesForAssimp() override;

  /// `text` instead of the file `path`; the scene's own, or one beside it.
  void replace(const std::filesystem::path& path, std::string text) {
    texts_[path.string()] = std::move(text);
  }

  bool Exists(const char* file) const override;
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;

 private:
  /// As the scene states it: Assimp has put the scene's folder before it.
  std::string stated(const char* file) const;

  const SourceFile& source_;
  std::map<std::string, std::string> texts_;
  std::set<Assimp::IOStream*> open_;  ///< some of Assimp's readers delete theirs without Close()
};

}  // namespace luxel::import
