// A glTF document while it is being written: its JSON, and the bytes of its one buffer.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/base/vec_double.h"

namespace luxel::export_ {

struct Glb {
  nlohmann::json json = nlohmann::json::object();
  std::vector<std::byte> buffer;
  std::set<std::string> extensions_used;
  /// Accessors by a digest of their bytes and kind: what is alike stands in the file once.
  std::unordered_multimap<uint64_t, size_t> accessor_of_digest = {};
  DVec3 origin = {};  ///< Scene::origin: nodes stand in the world of the file
};

/// Appends `value` to the top-level array `array` and returns its index.
size_t append(Glb& glb, const char* array, nlohmann::json value);

/// Appends bytes to the buffer, at a multiple of 4, as a bufferView; returns its index.
/// Target and stride 0 are left out (pictures have neither, indices no stride).
size_t append_view(Glb& glb, std::span<const std::byte> bytes, int target, size_t stride);

/// Vertex attributes as accessors of floats with their bounds. Not empty. An accessor of the same
/// values is used again, here and for indices.
size_t append_accessor(Glb& glb, std::span<const Vec2> values);
size_t append_accessor(Glb& glb, std::span<const Vec3> values);
size_t append_accessor(Glb& glb, std::span<const std::array<float, 4>> values);
/// Triangle corners: 16 bits wide where they fit, else 32.
size_t append_indices(Glb& glb, std::span<const uint32_t> indices);

/// The file: header, JSON chunk, BIN chunk. Error: more bytes than the format can count.
Result<std::vector<std::byte>> finish(Glb glb);

}  // namespace luxel::export_
