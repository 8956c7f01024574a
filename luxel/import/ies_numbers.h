// The numbers of an IES file, one after the other, whatever lines they stand on. For this room
// only.
#pragma once

#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "luxel/base/result.h"

namespace luxel::import {

class IesNumbers {
 public:
  /// `text` begins at line `line` (from 1) of the file `name`.
  IesNumbers(std::string_view text, int line, std::string name)
      : rest_(text), line_(line), name_(std::move(name)) {}

  /// The next number; `what` it is, for the sentence.
  Result<double> next(std::string_view what) {
    const std::string_view word = next_word();
    if (word.empty())
      return fail(ErrorCode::bad_input, "{}: it ends in line {} where {} should be", name_, line_,
                  what);
    const std::string_view digits = word.front() == '+' ? word.substr(1) : word;
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value))
      return fail(ErrorCode::bad_input, "{}: line {}: {} '{}' is not a number", name_, line_, what,
                  word.substr(0, 40));
    return value;
  }

  /// The next number, which must lie from `low` to `high`.
  Result<double> within(std::string_view what, double low, double high) {
    LUXEL_TRY(const double value, next(what));
    if (value >= low && value <= high) return value;
    return fail(ErrorCode::bad_input, "{}: line {}: {} {} is outside {} to {}", name_, line_, what,
                value, low, high);
  }

  /// The next number, which must be whole.
  Result<int> count(std::string_view what, int low, int high) {
    LUXEL_TRY(const double value, within(what, low, high));
    if (value == std::floor(value)) return int(value);
    return fail(ErrorCode::bad_input, "{}: line {}: {} {} is not a whole number", name_, line_,
                what, value);
  }

  /// Nothing may follow.
  Status end() {
    const std::string_view word = next_word();
    if (word.empty()) return {};
    return fail(
        ErrorCode::bad_input,
        "{}: line {}: '{}' follows the last candela that the numbers of angles allow; correct them",
        name_, line_, word.substr(0, 40));
  }

  int line() const { return line_; }  ///< of the number read last
  const std::string& name() const { return name_; }

 private:
  /// Commas count as blanks; DOS ended files with the character 26.
  static constexpr std::string_view kBetween = " \t\r\n,\x1a";

  std::string_view next_word() {
    size_t start = 0;
    while (start < rest_.size() && kBetween.find(rest_[start]) != std::string_view::npos)
      line_ += rest_[start++] == '\n' ? 1 : 0;
    const size_t end = std::min(rest_.find_first_of(kBetween, start), rest_.size());
    const std::string_view word = rest_.substr(start, end - start);
    rest_.remove_prefix(end);
    return word;
  }

  std::string_view rest_;
  int line_;
  std::string name_;
};

}  // namespace luxel::import
