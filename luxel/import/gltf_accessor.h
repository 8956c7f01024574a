// The numbers of glTF accessors: any component type, strided, normalised, sparse.
#pragma once

#include <tiny_gltf.h>

#include <string>
#include <vector>

#include "luxel/base/result.h"

namespace luxel::import {

/// One row of `components` numbers per element.
struct Numbers {
  size_t components = 0;
  std::vector<float> values;
  size_t count() const { return components ? values.size() / components : 0; }
};

/// Integers that are marked `normalized` become [0, 1] or [-1, 1]; others keep their value
/// (KHR_mesh_quantization). The document has passed check_document(), so that every byte that the
/// accessor names is there. `where` is named in errors: a type that is not one of `components`,
/// sparse indices out of range.
Result<Numbers> read_numbers(const tinygltf::Model& model, int accessor,
                             std::initializer_list<size_t> components, const std::string& where);

/// Vertex indices, of any unsigned type. Errors: another type.
Result<std::vector<uint32_t>> read_indices(const tinygltf::Model& model, int accessor,
                                           const std::string& where);

}  // namespace luxel::import
