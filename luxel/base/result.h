// Expected failures: a short code that a caller can act on, and a sentence for people.
#pragma once

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "luxel/base/check.h"

namespace luxel {
inline namespace base {

/// Kind of a failure.
enum class ErrorCode {
  bad_input,      ///< a file's content is wrong
  unsupported,    ///< a file asks for something luxel does not know
  bad_setting,    ///< an option has a value that cannot work
  io,             ///< a file cannot be read or written
  out_of_memory,  ///< a stated memory limit is too small
  out_of_disk,    ///< the disk is full
  out_of_time,    ///< a stated time limit is too short
  no_device,      ///< a graphics device or a display is missing, or is lost
  parts_missing,  ///< what follows needs parts that other processes work on
  cancelled,      ///< the user stopped the work
};

/// `message` says what, where, which value, and what to do; it ends without a full stop.
struct Error {
  ErrorCode code = ErrorCode::bad_input;
  std::string message;
};

/// An Error on its way into a Result: `return fail(...)`.
struct Failure {
  Error error;
};

/// A T or an Error, with the names of C++23's std::expected, which g++ 12 lacks in C++20 mode. A
/// class of our own, because every room instantiates it for some forty types: tl::expected has six
/// layers of base classes, a tenth of a whole build.
template <class T>
class [[nodiscard]] Result {
 public:
  using value_type = T;

  Result() : Result(T()) {}
  template <class U = T>
  requires(std::is_convertible_v<U, T> && !std::is_same_v<std::remove_cvref_t<U>, Result>)
      Result(U&& value)
      : value_(std::forward<U>(value)), has_value_(true) {}
  Result(Failure failure) : error_(std::move(failure.error)), has_value_(false) {}
  Result(Result&& other) : has_value_(other.has_value_) {
    has_value_ ? put(value_, std::move(other.value_)) : put(error_, std::move(other.error_));
  }
  Result(const Result& other) requires(std::is_copy_constructible_v<T>)
      : has_value_(other.has_value_) {
    has_value_ ? put(value_, other.value_) : put(error_, other.error_);
  }
  Result& operator=(Result other) {
    std::destroy_at(this);
    return *std::construct_at(this, std::move(other));
  }
  ~Result() { has_value_ ? std::destroy_at(&value_) : std::destroy_at(&error_); }

  explicit operator bool() const { return has_value_; }
  bool has_value() const { return has_value_; }
  T& operator*() & { return value_; }
  const T& operator*() const& { return value_; }
  T&& operator*() && { return std::move(value_); }
  T* operator->() { return &value_; }
  const T* operator->() const { return &value_; }
  /// Aborts where there is none.
  T& value() & { return checked().value_; }
  const T& value() const& { return checked().value_; }
  T&& value() && { return std::move(checked().value_); }
  template <class U>
  T value_or(U&& other) const& {
    return has_value_ ? value_ : static_cast<T>(std::forward<U>(other));
  }
  /// Only where there is no value.
  Error& error() & { return error_; }
  const Error& error() const& { return error_; }
  Error&& error() && { return std::move(error_); }
  /// f of the value, or the error.
  template <class F>
  auto map(F&& f) && -> Result<std::invoke_result_t<F, T&&>> {
    if (!has_value_) return Failure{std::move(error_)};
    if constexpr (std::is_void_v<std::invoke_result_t<F, T&&>>) {
      std::forward<F>(f)(std::move(value_));
      return {};
    } else {
      return std::forward<F>(f)(std::move(value_));
    }
  }

 private:
  template <class Member, class From>
  static void put(Member& member, From&& from) {
    std::construct_at(&member, std::forward<From>(from));
  }
  Result& checked() {
    LUXEL_CHECK(has_value_);
    return *this;
  }
  const Result& checked() const {
    LUXEL_CHECK(has_value_);
    return *this;
  }

  union {
    T value_;
    Error error_;
  };
  bool has_value_;
};

/// Success without a value, or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Failure failure) : error_(std::move(failure.error)) {}

  explicit operator bool() const { return !error_; }
  bool has_value() const { return !error_; }
  /// Aborts where there was a failure.
  void value() const { LUXEL_CHECK(!error_); }
  /// Only where there was a failure.
  Error& error() & { return *error_; }
  const Error& error() const& { return *error_; }
  Error&& error() && { return *std::move(error_); }

 private:
  std::optional<Error> error_;
};
using Status = Result<void>;

/// An Error to be returned, its message put together as by fmt::format.
template <class... Args>
Failure fail(ErrorCode code, fmt::format_string<Args...> text, Args&&... args) {
  return {{code, fmt::format(text, std::forward<Args>(args)...)}};
}

}  // namespace base
}  // namespace luxel

#define LUXEL_CONCAT_INNER(a, b) a##b
#define LUXEL_CONCAT(a, b) LUXEL_CONCAT_INNER(a, b)

/// LUXEL_TRY(const Scene scene, import_scene(path)); returns the error, or declares the value.
#define LUXEL_TRY(declaration, expression)                                        \
  auto LUXEL_CONCAT(luxel_try_, __LINE__) = (expression);                         \
  if (!LUXEL_CONCAT(luxel_try_, __LINE__))                                        \
    return luxel::Failure{std::move(LUXEL_CONCAT(luxel_try_, __LINE__)).error()}; \
  declaration = std::move(*LUXEL_CONCAT(luxel_try_, __LINE__))

/// LUXEL_TRY_STATUS(write(...)); returns the error, or goes on.
#define LUXEL_TRY_STATUS(expression)                                                   \
  do {                                                                                 \
    auto luxel_try_status = (expression);                                              \
    if (!luxel_try_status) return luxel::Failure{std::move(luxel_try_status).error()}; \
  } while (false)
