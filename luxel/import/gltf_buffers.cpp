#include "luxel/import/gltf_buffers.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "luxel/import/gltf_images.h"

namespace luxel::import {
namespace {

/// Bytes that base64 stands for, up to the first character that is none of its own, as tinygltf
/// reads it. [RFC 4648, section 4]
size_t bytes_in_base64(std::string_view text) {
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const size_t count = std::min(text.find_first_not_of(kAlphabet), text.size());
  return count / 4 * 3 + (count % 4 > 0 ? count % 4 - 1 : 0);
}

/// 0 when it is not known; who reads the buffer says why.
uint64_t true_length(const std::string& uri, const SceneFiles& files) {
  constexpr std::string_view kMark = ";base64,";
  if (uri.starts_with("data:")) {
    const size_t mark = uri.find(kMark);
    return mark == uri.npos ? 0
                            : bytes_in_base64(std::string_view(uri).substr(mark + kMark.size()));
  }
  const auto file = find_named_file(files, decoded_uri(uri), "a buffer");
  std::error_code error;
  if (!file || !std::filesystem::is_regular_file(*file, error)) return 0;
  const uint64_t length = std::filesystem::file_size(*file, error);
  return error ? 0 : length;
}

}  // namespace

void state_true_lengths(Json& document, const SceneFiles& files) {
  const auto buffers = document.find("buffers");
  if (buffers == document.end()) return;
  for (Json& buffer : *buffers) {
    const auto uri = buffer.find("uri");
    if (uri == buffer.end() || !uri->is_string()) continue;
    if (const uint64_t length = true_length(*uri, files); length > 0) buffer["byteLength"] = length;
  }
}

}  // namespace luxel::import
