// Plain values into bytes and back, in the machine's order.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace luxel {
inline namespace base {

struct ByteWriter {
  std::vector<std::byte> bytes;

  template <class T>
  void put(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (values.empty()) return;
    const size_t at = bytes.size();
    bytes.resize(at + values.size_bytes());
    std::memcpy(bytes.data() + at, values.data(), values.size_bytes());
  }
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void put_value(const T& value) { put(std::span<const T>(&value, 1)); }
};

/// Takes values from the front. What would go beyond the end is zeros, and `ok` is false then.
struct ByteReader {
  std::span<const std::byte> bytes;
  bool ok = true;

  template <class T>
  void get(std::span<T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto out = std::as_writable_bytes(values);
    ok = ok && out.size() <= bytes.size();
    if (out.empty()) return;
    if (!ok) {
      std::memset(out.data(), 0, out.size());
      return;
    }
    std::memcpy(out.data(), bytes.data(), out.size());
    bytes = bytes.subspan(out.size());
  }
  template <class T>
  requires std::is_trivially_copyable_v<T> T get_value() {
    T value{};
    get(std::span<T>(&value, 1));
    return value;
  }
  /// Everything was there, and nothing is left.
  bool ended_well() const { return ok && bytes.empty(); }
};

}  // namespace base
}  // namespace luxel
