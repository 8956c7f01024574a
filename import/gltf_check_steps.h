// The steps of check_document(), for its own files only.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "base/result.h"

namespace luxel::import {

using Json = nlohmann::json;

/// The top-level lists are lists of objects, and so are the primitives of meshes.
Status check_lists(const Json& document, const std::string& file);
/// Every index points at something.
Status check_indices(const Json& document, const std::string& file);
/// Views lie in their buffers, accessors in their views.
Status check_ranges(const Json& document, const std::string& file);
/// No node has two parents or is its own ancestor.
Status check_trees(const Json& document, const std::string& file);

/// "mesh 3 (chair)", from the object's name.
std::string name_of(const char* kind, size_t index, const Json& object);

/// The list under a key; empty when absent. Only after check_lists().
const Json& list_of(const Json& document, const char* key);

/// A whole number from 0 up to 2^53, so that sums of a few cannot overflow. `fallback` when absent.
Result<uint64_t> whole_number(const Json& object, const char* key, uint64_t fallback,
                              const std::string& where);

}  // namespace luxel::import
