#include "luxel/export/glb.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "luxel/base/check.h"
#include "luxel/base/digest.h"
#include "luxel/base/shown_text.h"
#include "luxel/export/json_parts.h"

namespace luxel::export_ {
namespace {

using nlohmann::json;

static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;

void pad_to_4(std::vector<std::byte>& bytes, std::byte with) {
  while (bytes.size() % 4 != 0) bytes.push_back(with);
}

void append_u32(std::vector<std::byte>& bytes, uint32_t value) {
  const auto raw = std::as_bytes(std::span(&value, 1));
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// True where an accessor holds these bytes.
bool holds(const Glb& glb, const json& accessor, const json& kind,
           std::span<const std::byte> bytes) {
  for (const auto& [key, value] : kind.items())
    if (accessor.at(key) != value) return false;
  const json& view = glb.json.at("bufferViews").at(accessor.at("bufferView").get<size_t>());
  return view.at("byteLength").get<size_t>() == bytes.size() &&
         std::memcmp(glb.buffer.data() + view.at("byteOffset").get<size_t>(), bytes.data(),
                     bytes.size()) == 0;
}

/// An accessor of `bytes` with the keys of `kind`: one that is there, or a new one, which gets what
/// `bounds` says, too. View: its target and stride.
template <class Bounds>
size_t find_or_append(Glb& glb, std::span<const std::byte> bytes, json kind, int target,
                      size_t stride, const Bounds& bounds) {
  Digest digest;
  digest.add(bytes), digest.add(json_text(kind));
  const auto [begin, end] = glb.accessor_of_digest.equal_range(digest.value());
  for (auto known = begin; known != end; ++known)
    if (holds(glb, glb.json["accessors"][known->second], kind, bytes)) return known->second;
  bounds(kind);
  kind["bufferView"] = append_view(glb, bytes, target, stride);
  const size_t made = append(glb, "accessors", std::move(kind));
  glb.accessor_of_digest.emplace(digest.value(), made);
  return made;
}

/// `components` floats per value, `count` values.
size_t append_floats(Glb& glb, std::span<const std::byte> bytes, const char* type,
                     size_t components) {
  LUXEL_CHECK(!bytes.empty());
  const size_t count = bytes.size() / (components * sizeof(float));
  const auto bounds = [&](json& accessor) {
    std::vector<float> lower(components, INFINITY), upper(components, -INFINITY);
    for (size_t i = 0; i < count * components; ++i) {
      float v;
      std::memcpy(&v, bytes.data() + i * sizeof(float), sizeof(float));
      LUXEL_CHECK(std::isfinite(v));
      lower[i % components] = std::min(lower[i % components], v);
      upper[i % components] = std::max(upper[i % components], v);
    }
    accessor["min"] = lower, accessor["max"] = upper;
  };
  return find_or_append(glb, bytes, {{"componentType", kFloat}, {"count", count}, {"type", type}},
                        kArrayBuffer, components * sizeof(float), bounds);
}

}  // namespace

size_t append(Glb& glb, const char* array, json value) {
  json& list = array_in(glb.json, array);
  list.push_back(std::move(value));
  return list.size() - 1;
}

size_t append_view(Glb& glb, std::span<const std::byte> bytes, int target, size_t stride) {
  LUXEL_CHECK(!bytes.empty());
  pad_to_4(glb.buffer, std::byte{0});
  json view = {{"buffer", 0}, {"byteOffset", glb.buffer.size()}, {"byteLength", bytes.size()}};
  if (target != 0) view["target"] = target;
  if (stride != 0) view["byteStride"] = stride;
  glb.buffer.insert(glb.buffer.end(), bytes.begin(), bytes.end());
  return append(glb, "bufferViews", std::move(view));
}

size_t append_accessor(Glb& glb, std::span<const Vec2> values) {
  static_assert(sizeof(Vec2) == 2 * sizeof(float));
  return append_floats(glb, std::as_bytes(values), "VEC2", 2);
}

size_t append_accessor(Glb& glb, std::span<const Vec3> values) {
  static_assert(sizeof(Vec3) == 3 * sizeof(float));
  return append_floats(glb, std::as_bytes(values), "VEC3", 3);
}

size_t append_accessor(Glb& glb, std::span<const std::array<float, 4>> values) {
  return append_floats(glb, std::as_bytes(values), "VEC4", 4);
}

size_t append_indices(Glb& glb, std::span<const uint32_t> indices) {
  LUXEL_CHECK(!indices.empty());
  const auto found = std::minmax_element(indices.begin(), indices.end());
  const uint32_t lowest = *found.first, highest = *found.second;
  const bool narrow = highest < 65535;  // 65535 itself would restart a strip
  const std::vector<uint16_t> shorts =
      narrow ? std::vector<uint16_t>(indices.begin(), indices.end()) : std::vector<uint16_t>{};
  const auto bytes = narrow ? std::as_bytes(std::span(shorts)) : std::as_bytes(indices);
  const json kind = {{"componentType", narrow ? kUnsignedShort : kUnsignedInt},
                     {"count", indices.size()},
                     {"type", "SCALAR"}};
  return find_or_append(glb, bytes, kind, kElementArrayBuffer, 0, [&](json& accessor) {
    accessor["min"] = {lowest}, accessor["max"] = {highest};
  });
}

Result<std::vector<std::byte>> finish(Glb glb) {
  std::vector<std::byte> binary = std::move(glb.buffer);
  pad_to_4(binary, std::byte{0});
  json document = std::move(glb.json);
  if (!glb.extensions_used.empty()) document["extensionsUsed"] = glb.extensions_used;
  if (!binary.empty()) document["buffers"] = json::array({{{"byteLength", binary.size()}}});
  // Names from files need not be valid UTF-8: what is not becomes U+FFFD instead of an exception.
  const std::string text = json_text(document);
  std::vector<std::byte> chunk(text.size());
  std::memcpy(chunk.data(), text.data(), text.size());
  pad_to_4(chunk, std::byte{' '});

  const size_t total = 12 + 8 + chunk.size() + (binary.empty() ? 0 : 8 + binary.size());
  if (total > UINT32_MAX)
    return fail(ErrorCode::unsupported,
                "the scene needs {} bytes as .glb, and the format allows {} at most; bake it in "
                "parts or with smaller textures",
                total, UINT32_MAX);
  std::vector<std::byte> out;
  out.reserve(total);
  append_u32(out, 0x46546C67);  // "glTF"
  append_u32(out, 2);
  append_u32(out, uint32_t(total));
  append_u32(out, uint32_t(chunk.size()));
  append_u32(out, 0x4E4F534A);  // "JSON"
  out.insert(out.end(), chunk.begin(), chunk.end());
  if (!binary.empty()) {
    append_u32(out, uint32_t(binary.size()));
    append_u32(out, 0x004E4942);  // "BIN\0"
    out.insert(out.end(), binary.begin(), binary.end());
  }
  return out;
}

}  // namespace luxel::export_
