// Structs to bytes and back. A struct says once what it holds,
//
//   template <class Archive>
//   void fields(Archive& a, Is<Cluster> auto& x) { a(x.first, x.end, x.child, x.depth); }
//
// and both the writer and the reader are given that. Numbers are little-endian, a list is its
// length (u64) and its elements and begins and ends at a multiple of 8 bytes, so that any language
// can view lists of numbers in place.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "luxel/base/result.h"

namespace luxel::matrix {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie");
static_assert(sizeof(float) == 4 && sizeof(double) == 8);

/// x is a T, to be written (const) or read.
template <class X, class T>
concept Is = std::same_as<std::remove_const_t<X>, T>;

template <class X>
concept Number = std::is_arithmetic_v<X> || std::is_enum_v<X> || std::same_as<X, std::byte>;

inline constexpr size_t kAlignment = 8;

/// The least bytes that something takes, all lists in it being empty.
class LeastBytes {
 public:
  size_t bytes = 0;

  template <class... X>
  void operator()(const X&... x) {
    (add(x), ...);
  }

 private:
  template <Number X>
  void add(const X&) {
    bytes += sizeof(X);
  }
  template <class X>
  void add(const X& x) {
    fields(*this, x);
  }
  template <class X, size_t N>
  void add(const std::array<X, N>& x) {
    for (const X& element : x) add(element);
  }
  template <class X>
  void add(const std::vector<X>&) {
    bytes += sizeof(uint64_t);
  }
  void add(const std::string&) { bytes += sizeof(uint64_t); }
};

template <class X>
size_t least_bytes() {
  LeastBytes least;
  least(X{});
  return least.bytes;
}

/// Appends to `bytes`.
class Writer {
 public:
  std::vector<std::byte> bytes;

  template <class... X>
  void operator()(const X&... x) {
    (put(x), ...);
  }
  void align() { bytes.resize((bytes.size() + kAlignment - 1) / kAlignment * kAlignment); }
  void raw(const void* from, size_t count) {
    const auto* first = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), first, first + count);
  }

 private:
  template <Number X>
  void put(const X& x) {
    raw(&x, sizeof x);
  }
  template <class X>
  void put(const X& x) {
    fields(*this, x);
  }
  template <class X, size_t N>
  void put(const std::array<X, N>& x) {
    if constexpr (Number<X>)
      raw(x.data(), sizeof x);
    else
      for (const X& element : x) put(element);
  }
  template <class List>
  void put_list(const List& list) {
    align();
    put(uint64_t(list.size()));
    if constexpr (Number<typename List::value_type>)
      raw(list.data(), list.size() * sizeof(list[0]));
    else
      for (const auto& element : list) put(element);
    align();
  }
  template <class X>
  void put(const std::vector<X>& x) {
    put_list(x);
  }
  void put(const std::string& x) { put_list(x); }
  template <class... X>
  void put(const std::variant<X...>& x) {
    put(uint32_t(x.index()));
    std::visit([this](const auto& held) { this->put(held); }, x);
  }
};

/// Reads what Writer wrote. The first fault stays in error(), and nothing is read after it.
/// Nothing is allocated that the bytes that are left do not justify.
class Reader {
 public:
  /// `where` begins error sentences: the file and the part of it. The bytes stand at `offset` of
  /// the file.
  Reader(std::span<const std::byte> bytes, std::string where, size_t offset)
      : bytes_(bytes), where_(std::move(where)), offset_(offset) {}

  template <class... X>
  void operator()(X&... x) {
    (get(x), ...);
  }
  void align() {
    while (!error_ && position_ % kAlignment != 0) {
      std::byte filler{};
      raw(&filler, 1);
      if (filler != std::byte{}) fault("a byte that only fills up is not 0");
    }
  }
  /// The end of the part.
  void end() {
    align();
    if (left() > 0) fault(fmt::format("{} bytes are left over", left()));
  }
  size_t left() const { return bytes_.size() - position_; }
  const std::optional<Error>& error() const { return error_; }

  void fault(const std::string& what) {
    if (!error_)
      error_ = Error{ErrorCode::bad_input,
                     fmt::format("{}, byte {}: {}; the file is damaged: copy or make it again",
                                 where_, offset_ + position_, what)};
  }

 private:
  void raw(void* to, size_t count) {
    if (count > left()) fault(fmt::format("{} bytes are wanted, {} are left", count, left()));
    if (error_ || count == 0) return;
    std::memcpy(to, bytes_.data() + position_, count);
    position_ += count;
  }
  template <Number X>
  void get(X& x) {
    raw(&x, sizeof x);
  }
  template <class X>
  void get(X& x) {
    fields(*this, x);
  }
  template <class X, size_t N>
  void get(std::array<X, N>& x) {
    if constexpr (Number<X>)
      raw(x.data(), sizeof x);
    else
      for (X& element : x) get(element);
  }
  template <class List>
  void get_list(List& list) {
    using X = typename List::value_type;
    uint64_t count = 0;
    align();
    get(count);
    const size_t each = least_bytes<X>();
    if (!error_ && count > left() / each)
      fault(fmt::format("a list of {} elements of {} bytes or more, {} bytes are left", count, each,
                        left()));
    if (error_) return;
    list.resize(size_t(count));
    if constexpr (Number<X>)
      raw(list.data(), list.size() * sizeof(X));
    else
      for (size_t k = 0; k < list.size() && !error_; ++k) get(list[k]);
    align();
  }
  template <class X>
  void get(std::vector<X>& x) {
    get_list(x);
  }
  void get(std::string& x) { get_list(x); }
  template <class... X>
  void get(std::variant<X...>& x) {
    uint32_t index = 0;
    get(index);
    if (index >= sizeof...(X)) fault(fmt::format("kind {}, of {} known", index, sizeof...(X)));
    if (!error_) emplace<0>(x, index);
    if (!error_) std::visit([this](auto& held) { this->get(held); }, x);
  }
  template <size_t I, class... X>
  static void emplace(std::variant<X...>& x, size_t index) {
    if (index == I)
      x.template emplace<I>();
    else if constexpr (I + 1 < sizeof...(X))
      emplace<I + 1>(x, index);
  }

  std::span<const std::byte> bytes_;
  std::string where_;
  size_t offset_ = 0, position_ = 0;
  std::optional<Error> error_;
};

}  // namespace luxel::matrix
