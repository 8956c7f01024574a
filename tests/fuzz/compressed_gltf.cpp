#include "tests/fuzz/compressed_gltf.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/fuzz/support.h"

namespace luxel::fuzz {
namespace {

using nlohmann::json;

size_t two_bytes(std::span<const std::byte> input, size_t at) {
  if (at + 2 > input.size()) return 0;
  return size_t(input[at]) | size_t(input[at + 1]) << 8;
}

json accessor(int component_type, size_t count, const char* type) {
  return {{"componentType", component_type}, {"count", count}, {"type", type}};
}

/// A scene of one node with one mesh of one primitive.
json scene_of(json primitive) {
  return {{"asset", {{"version", "2.0"}}},
          {"scene", 0},
          {"scenes", {{{"nodes", {0}}}}},
          {"nodes", {{{"mesh", 0}}}},
          {"meshes", {{{"primitives", {std::move(primitive)}}}}}};
}

std::vector<std::byte> glb_of(const json& scene, std::span<const std::byte> data) {
  std::string text = scene.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const size_t padded = (data.size() + 3) / 4 * 4;
  std::vector<std::byte> out;
  append_number(out, 0x46546c67, 4), append_number(out, 2, 4),
      append_number(out, 28 + text.size() + padded, 4);
  append_number(out, text.size(), 4), append_number(out, 0x4e4f534a, 4);
  for (const char c : text) out.push_back(std::byte(c));
  append_number(out, padded, 4), append_number(out, 0x004e4942, 4);
  out.insert(out.end(), data.begin(), data.end());
  out.resize(out.size() + padded - data.size());
  return out;
}

}  // namespace

std::vector<std::byte> draco_glb(std::span<const std::byte> input) {
  const size_t vertices = two_bytes(input, 0), triangles = two_bytes(input, 2);
  const std::span<const std::byte> data = input.subspan(std::min<size_t>(4, input.size()));
  const json compressed = {{"bufferView", 0},
                           {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}}};
  json scene = scene_of({{"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}},
                         {"indices", 3},
                         {"extensions", {{"KHR_draco_mesh_compression", compressed}}}});
  scene["extensionsUsed"] = scene["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  scene["accessors"] = {accessor(5126, vertices, "VEC3"), accessor(5126, vertices, "VEC3"),
                        accessor(5126, vertices, "VEC2"), accessor(5125, 3 * triangles, "SCALAR")};
  scene["buffers"] = {{{"byteLength", data.size()}}};
  scene["bufferViews"] = {{{"buffer", 0}, {"byteLength", data.size()}}};
  return glb_of(scene, data);
}

std::vector<std::byte> meshopt_glb(std::span<const std::byte> input) {
  constexpr size_t kHeader = 8;
  constexpr std::array kFilters{"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"};
  if (input.size() < kHeader) return {};
  const auto flags = unsigned(input[0]);
  const size_t stride = 4 * size_t(input[1]), vertices = two_bytes(input, 2),
               indices = two_bytes(input, 4), index_bytes = (flags & 8) != 0 ? 2 : 4;
  const std::span<const std::byte> data = input.subspan(kHeader);
  const size_t split = std::min(two_bytes(input, 6), data.size());
  const char* const name =
      (flags & 16) != 0 ? "KHR_meshopt_compression" : "EXT_meshopt_compression";
  size_t decoded = 0;
  const auto view = [&](size_t at, size_t length, size_t size, size_t count, const char* mode) {
    json compressed = {{"buffer", 0},        {"byteOffset", at}, {"byteLength", length},
                       {"byteStride", size}, {"count", count},   {"mode", mode}};
    if (mode == std::string("ATTRIBUTES"))
      compressed["filter"] = kFilters[(flags & 32) != 0 ? 4 : flags & 3];
    json out = {{"buffer", 1},
                {"byteOffset", decoded},
                {"byteLength", size * count},
                {"extensions", {{name, compressed}}}};
    if (mode == std::string("ATTRIBUTES")) out["byteStride"] = size;
    decoded += (size * count + 3) / 4 * 4;
    return out;
  };
  json scene = scene_of({{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}});
  scene["extensionsUsed"] = scene["extensionsRequired"] = {name};
  scene["bufferViews"] = {view(0, split, stride, vertices, "ATTRIBUTES"),
                          view(split, data.size() - split, index_bytes, indices,
                               (flags & 4) != 0 ? "TRIANGLES" : "INDICES")};
  scene["accessors"] = {accessor(stride < 12 ? 5120 : 5126, vertices, "VEC3"),
                        accessor(5120, vertices, "VEC3"),
                        accessor(index_bytes == 2 ? 5123 : 5125, indices, "SCALAR")};
  for (size_t k = 0; k < 3; ++k) scene["accessors"][k]["bufferView"] = k / 2;
  scene["accessors"][1]["normalized"] = true;
  scene["buffers"] = {{{"byteLength", data.size()}}, {{"byteLength", decoded}}};
  scene["buffers"][1]["extensions"][name]["fallback"] = true;
  return glb_of(scene, data);
}

}  // namespace luxel::fuzz
