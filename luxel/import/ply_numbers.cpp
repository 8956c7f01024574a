#include "luxel/import/ply_numbers.h"

#include <algorithm>
#include <bit>
#include <cfloat>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace luxel::import {
namespace {

template <class T>
double number_at(const char* p, bool reverse) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, p, sizeof(T));
  if (reverse) std::reverse(bytes, bytes + sizeof(T));
  return double(std::bit_cast<T>(bytes));
}

double number_at(const char* p, PlyType type, bool reverse) {
  switch (type) {
    case PlyType::i8:
      return number_at<int8_t>(p, reverse);
    case PlyType::u8:
      return number_at<uint8_t>(p, reverse);
    case PlyType::i16:
      return number_at<int16_t>(p, reverse);
    case PlyType::u16:
      return number_at<uint16_t>(p, reverse);
    case PlyType::i32:
      return number_at<int32_t>(p, reverse);
    case PlyType::u32:
      return number_at<uint32_t>(p, reverse);
    case PlyType::f32:
      return number_at<float>(p, reverse);
    case PlyType::f64:
      return number_at<double>(p, reverse);
    case PlyType::none:
      break;
  }
  return NAN;
}

template <class T>
void append_bytes(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// The smallest and largest number of a type, for those of a text.
std::pair<double, double> range_of(PlyType type) {
  switch (type) {
    case PlyType::i8:
      return {INT8_MIN, INT8_MAX};
    case PlyType::u8:
      return {0, UINT8_MAX};
    case PlyType::i16:
      return {INT16_MIN, INT16_MAX};
    case PlyType::u16:
      return {0, UINT16_MAX};
    case PlyType::i32:
      return {INT32_MIN, INT32_MAX};
    case PlyType::u32:
      return {0, UINT32_MAX};
    case PlyType::f32:
      return {-FLT_MAX, FLT_MAX};
    default:
      return {-DBL_MAX, DBL_MAX};
  }
}

/// A number that no double can hold since it is too near to 0, as 1e-400; it is taken for 0.
bool is_tiny(std::string_view word, double& value) {
  value = std::strtod(std::string(word).c_str(), nullptr);
  return std::abs(value) < 1;
}

/// A whole word as a number of its type; infinite and not a number are left to the caller.
bool is_number(std::string_view word, PlyType type, double& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const bool is_whole = type != PlyType::f32 && type != PlyType::f64;
  int64_t whole = 0;
  const auto [stop, error] = is_whole ? std::from_chars(word.data(), end, whole)
                                      : std::from_chars(word.data(), end, value);
  if (is_whole) value = double(whole);
  if (error == std::errc::invalid_argument || stop != end) return false;
  // Too large or too small for any number: from_chars() leaves the value as it was.
  if (error != std::errc()) return !is_whole && is_tiny(word, value);
  const auto [least, most] = range_of(type);
  return !std::isfinite(value) || (value >= least && value <= most);
}

}  // namespace

bool PlyNumbers::begin_element() {
  if (format != PlyHeader::Format::ascii) return true;
  if (rest.empty()) return false;
  const size_t length = std::min(rest.find('\n'), rest.size());
  line = rest.substr(0, length);
  rest.remove_prefix(std::min(length + 1, rest.size()));
  return true;
}

bool PlyNumbers::next(PlyType type, double& value) {
  if (format != PlyHeader::Format::ascii) {
    if (rest.size() < size_of(type)) return false;
    value = number_at(rest.data(), type, format == PlyHeader::Format::big);
    rest.remove_prefix(size_of(type));
    return true;
  }
  constexpr std::string_view kBlanks = " \t\r";
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const size_t length = std::min(line.find_first_of(kBlanks), line.size());
  const std::string_view word = line.substr(0, length);
  line.remove_prefix(length);
  return is_number(word, type, value);
}

size_t size_of(PlyType type) {
  constexpr size_t kSizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[size_t(type)];
}

void append(std::string& out, double value, PlyType type) {
  switch (type) {
    case PlyType::i8:
      return append_bytes(out, int8_t(value));
    case PlyType::u8:
      return append_bytes(out, uint8_t(value));
    case PlyType::i16:
      return append_bytes(out, int16_t(value));
    case PlyType::u16:
      return append_bytes(out, uint16_t(value));
    case PlyType::i32:
      return append_bytes(out, int32_t(value));
    case PlyType::u32:
      return append_bytes(out, uint32_t(value));
    case PlyType::f32:
      return append_bytes(out, float(value));
    case PlyType::f64:
      return append_bytes(out, value);
    case PlyType::none:
      break;
  }
}

}  // namespace luxel::import
