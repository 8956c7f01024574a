// The pictures of a file, whatever its format. For the readers of this room only.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/import/readers.h"

namespace luxel::import {

/// Ends of warnings: a material without one of its pictures.
inline constexpr std::string_view kColorInstead = "the material's colour is used",
                                  kNoHoles = "the material's colour is used, without holes",
                                  kNoGlow = "it does not glow", kNoMetal = "it is no metal",
                                  kNotClear = "it lets no light through",
                                  kNoBumps = "its normal map is left out";

/// Decodes pictures where a material first asks for them: files carry normal maps and variants that
/// nobody here looks at.
struct Pictures {
  const SourceFile& source;
  Imported& out;
  /// Number in the scene, by what pictures have in common.
  std::map<std::string, uint32_t> known{};
  std::set<std::pair<std::string, std::string>> lost{};  ///< the same, and `instead`
};

/// The number in the scene of the picture `key`; kNone for a lost one, which is missing, lies
/// elsewhere or has a format that luxel cannot decode: that is a warning, said once, which ends
/// with `instead`. `load` reads and decodes it: Result<scene::Texture>(). Errors: its other ones.
template <class Load>
Result<uint32_t> picture_of(Pictures& pictures, const std::string& key, std::string_view instead,
                            const Load& load) {
  const auto said = pictures.lost.find({key, std::string(instead)});
  if (said != pictures.lost.end()) return scene::kNone;
  if (const auto at = pictures.known.find(key); at != pictures.known.end()) return at->second;
  Result<scene::Texture> texture = load();
  if (!texture) {
    const Error& error = texture.error();
    if (error.code != ErrorCode::io && error.code != ErrorCode::unsupported) return Failure{error};
    pictures.out.warnings.push_back(fmt::format("{}; {}", error.message, instead));
    pictures.lost.insert({key, std::string(instead)});
    return scene::kNone;
  }
  pictures.out.scene.textures.push_back(std::move(*texture));
  return pictures.known[key] = uint32_t(pictures.out.scene.textures.size() - 1);
}

/// Decodes `encoded` and keeps it, unless glTF cannot hold it. `name` is the picture's file or
/// number, `user` asked for it. Errors: damaged; of no known format; more pixels than memory is
/// left for.
Result<scene::Texture> decode_texture(std::vector<std::byte> encoded, const std::string& name,
                                      const std::string& user, ReadingMemory& memory);

/// The picture of a file. `user` asks for it. Errors: those of read_named_picture() and
/// decode_texture().
Result<scene::Texture> load_picture(const SourceFile& source, const std::string& name,
                                    const std::string& user);

}  // namespace luxel::import
