// The files that Assimp opens. For the Assimp reader only.
#pragma once

#include <assimp/IOSystem.hpp>

#include <optional>
#include <set>
#include <string>

#include "luxel/import/readers.h"

namespace luxel::import {

/// The path of the scene's file as Assimp is told it: Assimp goes by the ending, luxel by the
/// content.
std::string path_for_assimp(const SourceFile& source);

/// Gives Assimp the scene's file from memory, or a text of ours in its place, and of all else only
/// what a scene may name (scene_files.h). Nothing is written.
class FilesForAssimp : public Assimp::IOSystem {
 public:
  /// `text`: what the scene's own file holds instead of its bytes.
  FilesForAssimp(const SourceFile& source, std::optional<std::string> text)
      : source_(source), own_(path_for_assimp(source)), text_(std::move(text)) {}
  /// Closes what Assimp has left open where it met an error.
  ~FilesForAssimp() override;

  bool Exists(const char* file) const override;
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;

 private:
  /// As the scene states it: Assimp has put the scene's folder before it.
  std::string stated(const char* file) const;

  const SourceFile& source_;
  const std::string own_;
  const std::optional<std::string> text_;
  std::set<Assimp::IOStream*> open_;  ///< some of Assimp's readers delete theirs without Close()
};

}  // namespace luxel::import
