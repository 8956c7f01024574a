// Checks that a glTF document must pass before tinygltf sees it.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "luxel/base/result.h"

namespace luxel::import {

/// The JSON text of a .glb, after its header and the bounds of its chunks have been checked.
Result<std::string> json_of_glb(std::span<const std::byte> bytes, const std::string& file);

/// The .glb with another JSON chunk. Only after json_of_glb() found it whole.
std::vector<std::byte> glb_with_json(std::span<const std::byte> bytes, std::string text);

/// Parses the text. Errors: not JSON (says where), not an object, nested too deep for recursion.
Result<nlohmann::json> parse_json(const std::string& text, const std::string& file);

/// Makes 12 of 12.0 where a whole number must stand: exporters written in JavaScript or Python
/// write so, and tinygltf would read 0. Returns true where it has changed something.
bool make_whole(nlohmann::json& document);

/// Errors: not glTF 2, a required extension that is not supported (named), lists that are not
/// lists, an index that points nowhere (names its holder), a member of the wrong kind, buffer views
/// past their buffer, accessors past their view, compressed parts that contradict themselves, nodes
/// that do not form trees. tinygltf checks none of these, and some of them make it read out of
/// bounds.
Status check_document(const nlohmann::json& document, const std::string& file);

/// Extensions that a file uses without requiring them, whose loss changes the light.
std::vector<std::string> ignored_extensions(const nlohmann::json& document);

}  // namespace luxel::import
