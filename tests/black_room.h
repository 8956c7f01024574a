// A room of boxes in a glTF file, for tests that hold illuminance against hand calculations.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "luxel/base/base64.h"
#include "luxel/base/vec.h"

namespace luxel::testing_support {

/// A glTF file of a room from `low` to `high`, whose front sides look inwards, all of one
/// reflectance, with a point light 'lamp' that shines downwards: its node's -z is -Y, its x is +X.
inline std::string room_gltf(Vec3 low, Vec3 high, float reflectance, Vec3 lamp, float candela) {
  std::vector<float> corners;
  for (int i = 0; i < 8; ++i) {
    const Vec3 p{i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
    corners.insert(corners.end(), {p.x, p.y, p.z});
  }
  // Counter-clockwise from inside: floor, ceiling, x low, x high, z low, z high.
  const std::vector<uint16_t> triangles{0, 4, 1, 1, 4, 5, 2, 3, 6, 3, 7, 6, 0, 2, 4, 2, 6, 4,
                                        1, 5, 3, 5, 7, 3, 0, 1, 2, 1, 3, 2, 4, 6, 5, 5, 6, 7};
  const auto data = [](const auto& v) {
    return "data:application/octet-stream;base64," + base64(std::as_bytes(std::span(v)));
  };
  using nlohmann::json;
  const json light{{"type", "point"}, {"intensity", candela}, {"name", "lamp"}};
  const json file{
      {"asset", {{"version", "2.0"}}},
      {"extensionsUsed", {"KHR_lights_punctual"}},
      {"extensions", {{"KHR_lights_punctual", {{"lights", {light}}}}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0, 1}}}}},
      {"nodes",
       {{{"mesh", 0}, {"name", "room"}},
        {{"name", "lamp"},
         {"translation", {lamp.x, lamp.y, lamp.z}},
         {"rotation", {-0.70710678, 0, 0, 0.70710678}},
         {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}}},
      {"materials",
       {{{"name", "paint"},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {reflectance, reflectance, reflectance, 1}},
           {"metallicFactor", 0}}}}}},
      {"meshes",
       {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}, {"material", 0}}}}}}},
      {"accessors",
       {{{"bufferView", 0},
         {"componentType", 5126},
         {"count", 8},
         {"type", "VEC3"},
         {"min", {low.x, low.y, low.z}},
         {"max", {high.x, high.y, high.z}}},
        {{"bufferView", 1}, {"componentType", 5123}, {"count", 36}, {"type", "SCALAR"}}}},
      {"bufferViews", {{{"buffer", 0}, {"byteLength", 96}}, {{"buffer", 1}, {"byteLength", 72}}}},
      {"buffers",
       {{{"byteLength", 96}, {"uri", data(corners)}},
        {{"byteLength", 72}, {"uri", data(triangles)}}}}};
  return file.dump();
}

}  // namespace luxel::testing_support
