// A glTF file as tinygltf's model, with every compressed part decoded. For the glTF reader only.
#pragma once

#include <tiny_gltf.h>

#include <nlohmann/json.hpp>

#include "luxel/base/result.h"
#include "luxel/import/readers.h"

namespace luxel::import {

struct LoadedGltf {
  nlohmann::json document;  ///< as the file says it, without its nodes, which the model has
  tinygltf::Model model;    ///< its accessors point at decoded bytes
};

/// Checks, tinygltf, then the decoders below. Errors: see check_document(), decode_meshopt(),
/// decode_draco(); a buffer that is not there.
Result<LoadedGltf> load_gltf(const SourceFile& source);

/// EXT_ and KHR_meshopt_compression: every compressed view of the model points at its decoded bytes
/// after. The document has passed check_document(). Errors: damaged data, naming the view; memory.
Status decode_meshopt(tinygltf::Model& model, const nlohmann::json& document,
                      const SourceFile& source);

/// KHR_draco_mesh_compression: every compressed primitive has accessors of its own after, with
/// decoded bytes, and is a list of triangles. The document has passed check_document(). Errors:
/// damaged data; vertices or triangles that are not as many, or not of the type, that the accessors
/// state. Each names mesh and primitive.
Status decode_draco(tinygltf::Model& model, const nlohmann::json& document,
                    const std::string& file);

/// KHR_materials_pbrSpecularGlossiness: said by metallic 0, roughness and KHR_materials_specular.
/// The document has passed check_document().
void convert_specular_glossiness(tinygltf::Model& model);

}  // namespace luxel::import
