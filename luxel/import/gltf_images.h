// The pictures of a glTF file. For the glTF reader only.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "luxel/import/gltf_parts.h"

namespace luxel::import {

/// Decodes pictures where a material first asks for them: files carry normal maps and variants that
/// nobody here looks at. Images that share their bytes, a file or a buffer view, are one texture.
class GltfImages {
 public:
  explicit GltfImages(GltfReader& reader) : reader_(reader) {}

  /// The scene's number of a glTF image. `user` asks for it. Errors: missing, damaged, more pixels
  /// than memory is left for.
  Result<uint32_t> load(int image, const std::string& user);

 private:
  GltfReader& reader_;
  std::map<std::string, uint32_t> known_;  ///< by what the images have in common
};

/// The bytes of an image of the document: a buffer view of the model, a data URI that the model
/// holds decoded, or a file.
Result<std::vector<std::byte>> encoded_image(const GltfReader& reader, size_t image,
                                             const std::string& what);

/// Takes images that lie in files and buffer views out of the document: tinygltf would read each of
/// them at once, and those that share their bytes once each. Its image has one byte then.
void leave_images_out(nlohmann::json& document);

/// "a%20b.png" to "a b.png".
std::string decoded_uri(std::string_view uri);

}  // namespace luxel::import
