// The steps of check_document(), for its own files only.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/result.h"

namespace luxel::import {

using Json = nlohmann::json;

/// The top-level lists are lists of objects, and so are the primitives of meshes.
Status check_lists(const Json& document, const std::string& file);
/// Every index points at something.
Status check_indices(const Json& document, const std::string& file);
/// Members are of the kind that glTF gives them, and whole numbers fit an int where tinygltf holds
/// them in one. Errors name the member by its path: "nodes/3/matrix is [1,2,3], must be ...".
Status check_members(const Json& document, const std::string& file);
/// Views lie in their buffers, accessors in their views.
Status check_ranges(const Json& document, const std::string& file);
/// EXT_ and KHR_meshopt_compression: see meshopt_view_of(); no picture lies in a compressed view,
/// nothing that is needed in a buffer marked as fallback.
Status check_meshopt(const Json& document, const std::string& file);
/// KHR_draco_mesh_compression: its view, attributes and mode are such as the extension allows.
Status check_draco(const Json& document, const std::string& file);
/// No node has two parents or is its own ancestor.
Status check_trees(const Json& document, const std::string& file);

/// "mesh 3 (chair)", from the object's name.
std::string name_of(const char* kind, size_t index, const Json& object);

/// The list under a key; empty when absent. Only after check_lists().
const Json& list_of(const Json& document, const char* key);

/// Calls check(primitive, where) for every primitive of every mesh until one fails. Only after
/// check_lists().
Status check_primitives(
    const Json& document, const std::string& file,
    const std::function<Status(const Json& primitive, const std::string& where)>& check);

/// The object's extension of this name, or null. Errors: it is not an object.
Result<const Json*> extension_of(const Json& object, const char* name, const std::string& where);

/// An index `target` names a list: `holder[key]`, when present, is a position in it.
Status check_index(const Json& document, const Json& holder, const char* key, const char* target,
                   const std::string& where);

/// A view that meshopt fills: where its compressed bytes lie and what they become.
struct MeshoptView {
  enum class Mode { attributes, triangles, indices };
  enum class Filter { none, octahedral, quaternion, exponential, color };
  bool khr = false;                             ///< KHR_meshopt_compression; else EXT_
  uint64_t buffer = 0, offset = 0, length = 0;  ///< compressed
  uint64_t stride = 0, count = 0;               ///< decoded
  Mode mode = Mode::attributes;
  Filter filter = Filter::none;
};

/// Nothing for a view without the extension. Errors: what the extension forbids
/// [KHR_meshopt_compression, "JSON schema updates"]; both extensions on one view; compressed bytes
/// that are not there, or too few for what they are said to become.
Result<std::optional<MeshoptView>> meshopt_view_of(const Json& document, const Json& view,
                                                   const std::string& where);

/// True: the primitive is compressed by KHR_draco_mesh_compression.
bool is_draco(const Json& primitive);

/// Buffers that hold nothing that is read, because meshopt brings all of their
/// views. Their bytes need not exist.
std::vector<bool> placeholder_buffers(const Json& document);

/// A whole number from 0 up to 2^53, so that sums of a few cannot overflow. `fallback` when absent.
Result<uint64_t> whole_number(const Json& object, const char* key, uint64_t fallback,
                              const std::string& where);

}  // namespace luxel::import
