#include "luxel/import/gltf_buffers.h"

#include <algorithm>
#include <string_view>

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

}  // namespace

void state_true_lengths(Json& document) {
  const auto buffers = document.find("buffers");
  if (buffers == document.end()) return;
  constexpr std::string_view kMark = ";base64,";
  for (Json& buffer : *buffers) {
    const auto uri = buffer.find("uri");
    if (uri == buffer.end() || !uri->is_string()) continue;
    const std::string_view text = uri->get_ref<const std::string&>();
    const size_t mark = text.find(kMark);
    if (!text.starts_with("data:") || mark == text.npos) continue;
    const size_t length = bytes_in_base64(text.substr(mark + kMark.size()));
    if (length > 0) buffer["byteLength"] = length;
  }
}

}  // namespace luxel::import
