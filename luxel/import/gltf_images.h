// The pictures of a glTF file. For the glTF reader only.
#pragma once

#include <string>
#include <vector>

#include "luxel/import/gltf_parts.h"
#include "luxel/import/pictures.h"

namespace luxel::import {

/// picture_of() a glTF image. Images that share their bytes, a file or a buffer view, are one
/// texture. Errors: damaged, more pixels than memory is left for.
Result<uint32_t> load_image(const GltfReader& reader, Pictures& pictures, int image,
                            const std::string& user, std::string_view instead);

/// The bytes of an image of the document: a buffer view of the model, a data URI or a file.
Result<std::vector<std::byte>> encoded_image(const GltfReader& reader, size_t image,
                                             const std::string& what);

/// "a%20b.png" to "a b.png".
std::string decoded_uri(std::string_view uri);

}  // namespace luxel::import
