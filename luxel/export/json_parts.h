// Parts of a JSON document that are made where they are missing.
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>

namespace luxel::export_ {

/// The object or array `json[key]`, made empty where it is missing or null.
/// nlohmann-json (3.11) makes a null an object or an array itself, by json["a"]["b"] and
/// json["a"].push_back(). It does so in two steps, though: the type first, then the memory. Where
/// there is none, the destructor follows a null pointer. Here the empty part is made whole before
/// it comes into the document.
inline nlohmann::json& part_of(nlohmann::json& json, const char* key,
                               nlohmann::json::value_t kind) {
  nlohmann::json& part = json[key];
  if (part.is_null()) part = nlohmann::json(kind);
  return part;
}

/// The object json[keys[0]][keys[1]]...
inline nlohmann::json& object_in(nlohmann::json& json, std::initializer_list<const char*> keys) {
  nlohmann::json* part = &json;
  for (const char* key : keys) part = &part_of(*part, key, nlohmann::json::value_t::object);
  return *part;
}

inline nlohmann::json& array_in(nlohmann::json& json, const char* key) {
  return part_of(json, key, nlohmann::json::value_t::array);
}

}  // namespace luxel::export_
