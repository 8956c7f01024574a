#include "luxel/import/gltf_buffers.h"

#include <algorithm>
#include <charconv>
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

/// "%20" to " ", as file names are written in a URI. [RFC 3986, section 2.1]
std::string decoded(std::string_view uri) {
  std::string out;
  for (size_t i = 0; i < uri.size(); ++i) {
    unsigned char byte = 0;
    const char* digits = uri.data() + i + 1;
    if (uri[i] == '%' && uri.size() - i > 2 &&
        std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      out += char(byte);
      i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

/// 0 when it is not known; who reads the buffer says why.
uint64_t true_length(const std::string& uri, const std::filesystem::path& folder) {
  constexpr std::string_view kMark = ";base64,";
  if (uri.starts_with("data:")) {
    const size_t mark = uri.find(kMark);
    return mark == uri.npos ? 0
                            : bytes_in_base64(std::string_view(uri).substr(mark + kMark.size()));
  }
  std::error_code error;
  const std::filesystem::path file = folder / decoded(uri);
  if (!std::filesystem::is_regular_file(file, error)) return 0;
  const uint64_t length = std::filesystem::file_size(file, error);
  return error ? 0 : length;
}

}  // namespace

void state_true_lengths(Json& document, const std::filesystem::path& folder) {
  const auto buffers = document.find("buffers");
  if (buffers == document.end()) return;
  for (Json& buffer : *buffers) {
    const auto uri = buffer.find("uri");
    if (uri == buffer.end() || !uri->is_string()) continue;
    if (const uint64_t length = true_length(*uri, folder); length > 0)
      buffer["byteLength"] = length;
  }
}

}  // namespace luxel::import
