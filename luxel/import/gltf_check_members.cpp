// Every member that is read is of the kind that glTF 2.0 gives it. tinygltf holds most whole
// numbers in an int, whatever the file says, and takes members of another kind for absent.
#include <cmath>
#include <iterator>

#include "luxel/base/check.h"
#include "luxel/import/gltf_check_steps.h"
#include "luxel/import/gltf_checks.h"

namespace luxel::import {
namespace {

enum class Kind {
  text,
  flag,
  number,
  numbers,  ///< any count
  numbers3,
  numbers4,
  numbers16,
  index,   ///< a whole number that fits an int
  length,  ///< a whole number up to 2^53
  object,
};

/// Members by their path; * is each element of a list or each member of an object.
struct Member {
  const char* path;
  Kind kind;
};
constexpr Member kMembers[] = {
    {"asset/minVersion", Kind::text},
    {"accessors/*/bufferView", Kind::index},
    {"accessors/*/byteOffset", Kind::length},
    {"accessors/*/componentType", Kind::index},
    {"accessors/*/count", Kind::length},
    {"accessors/*/normalized", Kind::flag},
    {"accessors/*/sparse", Kind::object},
    {"accessors/*/sparse/count", Kind::index},
    {"accessors/*/sparse/indices", Kind::object},
    {"accessors/*/sparse/indices/bufferView", Kind::index},
    {"accessors/*/sparse/indices/byteOffset", Kind::index},
    {"accessors/*/sparse/indices/componentType", Kind::index},
    {"accessors/*/sparse/values", Kind::object},
    {"accessors/*/sparse/values/bufferView", Kind::index},
    {"accessors/*/sparse/values/byteOffset", Kind::index},
    {"accessors/*/type", Kind::text},
    {"buffers/*/byteLength", Kind::length},
    {"buffers/*/uri", Kind::text},
    {"bufferViews/*/buffer", Kind::index},
    {"bufferViews/*/byteLength", Kind::length},
    {"bufferViews/*/byteOffset", Kind::length},
    {"bufferViews/*/byteStride", Kind::index},
    {"cameras/*/perspective", Kind::object},
    {"cameras/*/perspective/*", Kind::number},
    {"extensions/KHR_lights_punctual/lights/*/color", Kind::numbers3},
    {"extensions/KHR_lights_punctual/lights/*/intensity", Kind::number},
    {"extensions/KHR_lights_punctual/lights/*/range", Kind::number},
    {"extensions/KHR_lights_punctual/lights/*/spot", Kind::object},
    {"extensions/KHR_lights_punctual/lights/*/spot/innerConeAngle", Kind::number},
    {"extensions/KHR_lights_punctual/lights/*/spot/outerConeAngle", Kind::number},
    {"extensions/KHR_lights_punctual/lights/*/type", Kind::text},
    {"images/*/bufferView", Kind::index},
    {"images/*/mimeType", Kind::text},
    {"images/*/uri", Kind::text},
    {"materials/*/alphaCutoff", Kind::number},
    {"materials/*/alphaMode", Kind::text},
    {"materials/*/doubleSided", Kind::flag},
    {"materials/*/emissiveFactor", Kind::numbers3},
    {"materials/*/emissiveTexture", Kind::object},
    {"materials/*/emissiveTexture/index", Kind::index},
    {"materials/*/emissiveTexture/texCoord", Kind::index},
    {"materials/*/pbrMetallicRoughness", Kind::object},
    {"materials/*/pbrMetallicRoughness/baseColorFactor", Kind::numbers4},
    {"materials/*/pbrMetallicRoughness/baseColorTexture", Kind::object},
    {"materials/*/pbrMetallicRoughness/baseColorTexture/index", Kind::index},
    {"materials/*/pbrMetallicRoughness/baseColorTexture/texCoord", Kind::index},
    {"materials/*/pbrMetallicRoughness/metallicFactor", Kind::number},
    {"materials/*/pbrMetallicRoughness/roughnessFactor", Kind::number},
    {"meshes/*/primitives/*/attributes", Kind::object},
    {"meshes/*/primitives/*/attributes/*", Kind::index},
    {"meshes/*/primitives/*/indices", Kind::index},
    {"meshes/*/primitives/*/material", Kind::index},
    {"meshes/*/primitives/*/mode", Kind::index},
    {"meshes/*/weights", Kind::numbers},
    {"nodes/*/camera", Kind::index},
    {"nodes/*/matrix", Kind::numbers16},
    {"nodes/*/mesh", Kind::index},
    {"nodes/*/rotation", Kind::numbers4},
    {"nodes/*/scale", Kind::numbers3},
    {"nodes/*/skin", Kind::index},
    {"nodes/*/translation", Kind::numbers3},
    {"nodes/*/weights", Kind::numbers},
    {"samplers/*/magFilter", Kind::index},
    {"samplers/*/minFilter", Kind::index},
    {"samplers/*/wrapS", Kind::index},
    {"samplers/*/wrapT", Kind::index},
    {"skins/*/inverseBindMatrices", Kind::index},
    {"skins/*/skeleton", Kind::index},
    {"textures/*/sampler", Kind::index},
    {"textures/*/source", Kind::index},
};

bool is_whole(const Json& value, double largest) {
  if (!value.is_number()) return false;
  const auto number = value.get<double>();
  return number >= 0 && number <= largest && number == std::floor(number);
}

bool are_numbers(const Json& value, size_t count) {
  if (!value.is_array() || (count != 0 && value.size() != count)) return false;
  for (const Json& number : value)
    if (!number.is_number()) return false;
  return true;
}

/// Null, or what the member must be.
const char* wrong(const Json& value, Kind kind) {
  switch (kind) {
    case Kind::text:
      return value.is_string() ? nullptr : "a text";
    case Kind::flag:
      return value.is_boolean() ? nullptr : "true or false";
    case Kind::number:
      return value.is_number() ? nullptr : "a number";
    case Kind::numbers:
      return are_numbers(value, 0) ? nullptr : "a list of numbers";
    case Kind::numbers3:
      return are_numbers(value, 3) ? nullptr : "a list of 3 numbers";
    case Kind::numbers4:
      return are_numbers(value, 4) ? nullptr : "a list of 4 numbers";
    case Kind::numbers16:
      return are_numbers(value, 16) ? nullptr : "a list of 16 numbers";
    case Kind::index:
      return is_whole(value, INT32_MAX) ? nullptr : "a whole number from 0 to 2147483647";
    case Kind::length:
      return is_whole(value, 0x1p53) ? nullptr : "a whole number from 0 on";
    case Kind::object:
      return value.is_object() ? nullptr : "an object";
  }
  return nullptr;
}

/// A name or an element of a path, and the rest behind it; nothing behind the last one.
struct Step {
  std::string_view name, rest;
};
Step first_of(std::string_view path) {
  const size_t slash = path.find('/');
  if (slash == path.npos) return {path, {}};
  return {path.substr(0, slash), path.substr(slash + 1)};
}

/// Calls use(value) for every member of a path until one fails. `where` is that member's place
/// then. Members that are null count as absent.
template <class Value, class Use>
Status for_each_at(Value& holder, std::string_view path, std::string& where, const Use& use) {
  const auto [name, rest] = first_of(path);
  const size_t old = where.size();
  const auto enter = [&, rest = rest](Value& value, const auto& step) -> Status {
    if (value.is_null()) return {};
    fmt::format_to(std::back_inserter(where), "{}{}", old == 0 ? "" : "/", step);
    LUXEL_TRY_STATUS(rest.empty() ? use(value) : for_each_at(value, rest, where, use));
    where.resize(old);
    return {};
  };
  if (holder.is_array() && name == "*")
    for (size_t i = 0; i < holder.size(); ++i) LUXEL_TRY_STATUS(enter(holder[i], i));
  if (holder.is_object() && name == "*")
    for (auto item = holder.begin(); item != holder.end(); ++item)
      LUXEL_TRY_STATUS(enter(item.value(), item.key()));
  if (holder.is_object() && name != "*")
    if (const auto member = holder.find(std::string(name)); member != holder.end())
      LUXEL_TRY_STATUS(enter(*member, name));
  return {};
}

/// A value as text, without its end where it is long.
std::string shown(const Json& value) {
  constexpr size_t kMost = 60;
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  return text.size() <= kMost ? text : text.substr(0, kMost) + "...";
}

}  // namespace

bool make_whole(Json& document) {
  bool changed = false;
  const auto make = [&](Json& value) -> Status {
    if (value.is_number_float() && is_whole(value, 0x1p53)) {
      value = uint64_t(value.get<double>());
      changed = true;
    }
    return {};
  };
  std::string where;
  for (const Member& member : kMembers)
    if (member.kind == Kind::index || member.kind == Kind::length)
      LUXEL_CHECK(for_each_at(document, member.path, where, make));
  return changed;
}

Status check_members(const Json& document, const std::string& file) {
  std::string where;
  for (const Member& member : kMembers)
    LUXEL_TRY_STATUS(for_each_at(document, member.path, where, [&](const Json& value) -> Status {
      const char* const must = wrong(value, member.kind);
      if (must == nullptr) return {};
      return fail(ErrorCode::bad_input, "{}: {} is {}, must be {}", file, where, shown(value),
                  must);
    }));
  return {};
}

}  // namespace luxel::import
