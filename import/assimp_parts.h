// The parts of the Assimp reader. For its own files only.
#pragma once

#include "import/readers.h"

struct aiScene;

namespace luxel::import {

/// Fills scene.materials, in Assimp's order, and the textures they use. Errors: a texture that is
/// missing or corrupt. `with_color`, for .obj only, is check_obj()'s result.
Status read_assimp_materials(const aiScene& in, const SourceFile& source,
                             const std::set<std::string>& with_color, Imported& out);

}  // namespace luxel::import
