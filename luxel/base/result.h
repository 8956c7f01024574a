// Expected failures: a short code that a caller can act on, and a sentence for people.
#pragma once

#include <fmt/format.h>

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace luxel {
inline namespace base {

/// What kind of failure it was.
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

/// tl::expected has the names of C++23's std::expected, which g++ 12 lacks in C++20 mode.
template <class T>
using Result = tl::expected<T, Error>;
/// Success without a value, or an Error.
using Status = Result<void>;

/// An Error to be returned, its message put together as by fmt::format.
template <class... Args>
tl::unexpected<Error> fail(ErrorCode code, fmt::format_string<Args...> text, Args&&... args) {
  return tl::unexpected<Error>(Error{code, fmt::format(text, std::forward<Args>(args)...)});
}

}  // namespace base
}  // namespace luxel

#define LUXEL_CONCAT_INNER(a, b) a##b
#define LUXEL_CONCAT(a, b) LUXEL_CONCAT_INNER(a, b)

/// LUXEL_TRY(const Scene scene, import_scene(path)); returns the error, or declares the value.
#define LUXEL_TRY(declaration, expression)                                        \
  auto LUXEL_CONCAT(luxel_try_, __LINE__) = (expression);                         \
  if (!LUXEL_CONCAT(luxel_try_, __LINE__))                                        \
    return tl::unexpected(std::move(LUXEL_CONCAT(luxel_try_, __LINE__).error())); \
  declaration = std::move(*LUXEL_CONCAT(luxel_try_, __LINE__))

/// LUXEL_TRY_STATUS(write(...)); returns the error, or goes on.
#define LUXEL_TRY_STATUS(expression)                                                   \
  do {                                                                                 \
    auto luxel_try_status = (expression);                                              \
    if (!luxel_try_status) return tl::unexpected(std::move(luxel_try_status.error())); \
  } while (false)
