// The outside of a document: container, text, version, extensions, and the chain of checks.
#include "luxel/import/gltf_checks.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "luxel/import/gltf_check_steps.h"

namespace luxel::import {
namespace {

/// Extensions that luxel reads, or that change nothing about diffuse light.
constexpr std::string_view kSupported[] = {
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    // Textures that cannot be decoded are reported where they are needed. A normal map is not
    // needed.
    "KHR_texture_basisu",
    "KHR_texture_transform",
    // Shine, and data about data.
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_variants",
    "KHR_xmp",
    "KHR_xmp_json_ld",
};

bool is_supported(const std::string& extension) {
  return std::find(std::begin(kSupported), std::end(kSupported), extension) != std::end(kSupported);
}

Result<std::vector<std::string>> names_in(const Json& document, const char* key,
                                          const std::string& file) {
  std::vector<std::string> names;
  if (!document.contains(key)) return names;
  if (!document[key].is_array())
    return fail(ErrorCode::bad_input, "{}: {} is not a list of names", file, key);
  for (const Json& name : document[key]) {
    if (!name.is_string())
      return fail(ErrorCode::bad_input, "{}: {} is not a list of names", file, key);
    names.push_back(name.get<std::string>());
  }
  return names;
}

Status check_version(const Json& document, const std::string& file) {
  const auto asset = document.find("asset");
  if (asset == document.end() || !asset->is_object() || !asset->contains("version") ||
      !(*asset)["version"].is_string())
    return fail(ErrorCode::bad_input, "{}: it has no asset.version, so it is not glTF", file);
  const std::string version = (*asset)["version"];
  if (version.rfind("2.", 0) != 0)
    return fail(ErrorCode::unsupported, "{}: it is glTF {}; only glTF 2 can be read", file,
                version);
  const auto least = asset->find("minVersion");
  if (least != asset->end() && least->is_string() && *least != "2.0")
    return fail(ErrorCode::unsupported, "{}: it needs glTF {}; only glTF 2.0 can be read", file,
                least->get<std::string>());
  return {};
}

Status check_required_extensions(const Json& document, const std::string& file) {
  LUXEL_TRY(const auto required, names_in(document, "extensionsRequired", file));
  std::string unknown;
  for (const std::string& name : required)
    if (!is_supported(name)) unknown += (unknown.empty() ? "" : ", ") + name;
  if (!unknown.empty())
    return fail(ErrorCode::unsupported,
                "{}: it requires {}, which luxel does not support; export it without", file,
                unknown);
  LUXEL_TRY_STATUS(names_in(document, "extensionsUsed", file));
  return {};
}

uint32_t little_endian32(std::span<const std::byte> bytes, size_t at) {
  uint32_t value = 0;
  for (size_t k = 0; k < 4; ++k) value |= uint32_t(bytes[at + k]) << (8 * k);
  return value;
}

/// JSON is read by recursion in tinygltf: a text of a million brackets would overflow the stack.
bool is_nested_too_deep(const std::string& text) {
  constexpr int kMaxDepth = 128;
  int depth = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '{' || c == '[')
      if (++depth > kMaxDepth) return true;
    if (c == '}' || c == ']') --depth;
  }
  return false;
}

}  // namespace

Result<std::string> json_of_glb(std::span<const std::byte> bytes, const std::string& file) {
  constexpr uint32_t kMagic = 0x46546c67, kJson = 0x4e4f534a;
  // The header: magic, version, length.
  if (bytes.size() < 20 || little_endian32(bytes, 0) != kMagic)
    return fail(ErrorCode::bad_input, "{}: it is not a .glb file: its first bytes are not 'glTF'",
                file);
  if (little_endian32(bytes, 4) != 2)
    return fail(ErrorCode::unsupported, "{}: it is .glb version {}; only version 2 can be read",
                file, little_endian32(bytes, 4));
  const size_t length = little_endian32(bytes, 8);
  if (length > bytes.size())
    return fail(ErrorCode::bad_input,
                "{}: it is truncated: {} of {} bytes are there; copy or export it again", file,
                bytes.size(), length);
  // The chunks. The first is the JSON; the others only have to lie within the file.
  std::string text;
  for (size_t at = 12; at < length;) {
    if (length - at < 8 || little_endian32(bytes, at) > length - at - 8)
      return fail(ErrorCode::bad_input, "{}: the chunk at byte {} ends after the file", file, at);
    const size_t size = little_endian32(bytes, at);
    if (at == 12) {
      if (little_endian32(bytes, at + 4) != kJson)
        return fail(ErrorCode::bad_input, "{}: its first chunk is not JSON", file);
      text.assign(reinterpret_cast<const char*>(bytes.data()) + at + 8, size);
    }
    at += 8 + size;
  }
  return text;
}

std::vector<std::byte> glb_with_json(std::span<const std::byte> bytes, std::string text) {
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const size_t length = little_endian32(bytes, 8);
  const auto rest = bytes.subspan(20 + little_endian32(bytes, 12));  // the other chunks
  const size_t new_length = 20 + text.size() + (length - (bytes.size() - rest.size()));
  std::vector<std::byte> out(new_length);
  const auto put32 = [&](size_t at, size_t value) {
    for (size_t k = 0; k < 4; ++k) out[at + k] = std::byte(value >> (8 * k));
  };
  std::memcpy(out.data(), bytes.data(), 20);  // the header and that of the first chunk
  put32(8, new_length);
  put32(12, text.size());
  std::memcpy(out.data() + 20, text.data(), text.size());
  std::copy_n(rest.begin(), new_length - 20 - text.size(),
              out.begin() + ptrdiff_t(20 + text.size()));
  return out;
}

Result<Json> parse_json(const std::string& text, const std::string& file) {
  if (is_nested_too_deep(text))
    return fail(ErrorCode::bad_input, "{}: its JSON is nested too deeply to be glTF", file);
  try {
    Json document = Json::parse(text);
    if (!document.is_object())
      return fail(ErrorCode::bad_input, "{}: its JSON is not an object, so it is not glTF", file);
    return document;
  } catch (const Json::exception& e) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: ..."
    const std::string_view what = e.what();
    const size_t start = what.find("] ");
    return fail(ErrorCode::bad_input, "{}: its JSON is broken: {}", file,
                start == what.npos ? what : what.substr(start + 2));
  }
}

Status check_document(const Json& document, const std::string& file) {
  LUXEL_TRY_STATUS(check_version(document, file));
  LUXEL_TRY_STATUS(check_required_extensions(document, file));
  LUXEL_TRY_STATUS(check_lists(document, file));
  LUXEL_TRY_STATUS(check_indices(document, file));
  LUXEL_TRY_STATUS(check_members(document, file));
  LUXEL_TRY_STATUS(check_ranges(document, file));
  LUXEL_TRY_STATUS(check_meshopt(document, file));
  LUXEL_TRY_STATUS(check_draco(document, file));
  return check_trees(document, file);
}

std::vector<std::string> ignored_extensions(const Json& document) {
  std::vector<std::string> ignored;
  if (const auto used = document.find("extensionsUsed"); used != document.end())
    for (const Json& name : *used)
      if (!is_supported(name.get<std::string>())) ignored.push_back(name.get<std::string>());
  return ignored;
}

}  // namespace luxel::import
