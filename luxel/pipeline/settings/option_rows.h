// Makers of the rows of option tables. Only files that hold a table include this.
#pragma once

#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>
#include <utility>

#include "luxel/base/shown_text.h"
#include "luxel/pipeline/settings/option.h"

namespace luxel::pipeline {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// The values that a number may have, `low` and `high` among them. Its default is always allowed.
struct Range {
  double low = -kNoLimit, high = kNoLimit;
  /// The message for a value outside, after the option and the value:
  /// "is not an area; give m^2 >= 0". Empty: "is outside LOW to HIGH".
  std::string wrong = "";
  /// Advice, after the sentence above.
  std::string advice = "";
  /// `low` itself lies outside: the default 0 of an option means that it was not given.
  bool above = false;
};

/// "1 to 16384", ">= 0"; empty for a range without limits.
std::string text_of(const Range& range);
/// The error (bad_setting) of a value that lies outside.
Status out_of_range(std::string_view flag, const std::string& value, const Range& range);
/// "--max-leaf-lines" to "max_leaf_lines", "--no-stitch" to "stitch".
std::string key_of(std::string_view flag);
/// "[a, 2]" to "a,2", as options say it; a text as it is; anything else as JSON has it.
std::string option_text(const nlohmann::json& json);
/// The error (bad_setting) of a text that is no number.
Status not_a_number(std::string_view flag, std::string_view text);
/// The error (bad_setting) of a name that is not among those there are.
Status unknown_name(std::string_view flag, std::string_view name, std::string_view names);

/// True: the whole text is a number, of any size, or nan or inf.
bool is_number(std::string_view text);
/// The whole of the text as a finite number.
template <class T>
std::optional<T> number_from(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  if constexpr (std::is_floating_point_v<T>)
    if (!std::isfinite(value)) return std::nullopt;
  return value;
}

/// The shortest number that reads back as the same bits; 0.01f is 0.01.
template <class T>
nlohmann::json json_of_number(T value) {
  if constexpr (std::is_same_v<T, float>)
    return *number_from<double>(fmt::format("{}", value));
  else
    return value;
}

template <class T>
struct is_optional : std::false_type {};
template <class T>
struct is_optional<std::optional<T>> : std::true_type {};

/// Rows of a table for settings S. `access` is a pointer to a member, or a function of S& that
/// gives a reference, constant for a constant S.
template <class S>
struct Rows {
  using Row = Option<S>;
  template <class Access>
  using Value = std::remove_cvref_t<std::invoke_result_t<Access, S&>>;

  /// A number, or an optional one, which is "auto" in bake.json and on the command line where there
  /// is none.
  template <class Access>
  static Row number(std::string_view flag, Access access, Range range, std::string help) {
    using Held = Value<Access>;
    if constexpr (is_optional<Held>::value)
      return number_of<typename Held::value_type>(flag, access, std::move(range), std::move(help));
    else
      return number_of<Held>(flag, access, std::move(range), std::move(help));
  }

  /// One of several names.
  template <class Access>
  static Row choice(std::string_view flag, Access access,
                    std::vector<std::pair<std::string, Value<Access>>> names, std::string help) {
    std::string list, value;
    for (const auto& [name, ignored] : names)
      list += (list.empty() ? "" : ", ") + name, value += (value.empty() ? "" : "|") + name;
    const auto name_in = [access, names](const S& s) {
      for (const auto& [name, meaning] : names)
        if (std::invoke(access, s) == meaning) return name;
      return std::string("none");
    };
    Row row = plain(flag, std::move(help));
    row.value = std::move(value);
    row.read_text = [flag = row.flag, access, names, list](S& s, std::string_view text) -> Status {
      for (const auto& [name, meaning] : names)
        if (name == text) return std::invoke(access, s) = meaning, Status{};
      return unknown_name(flag, text, list);
    };
    row.read_json = [read = row.read_text, name_in, access](S& s,
                                                            const nlohmann::json& json) -> Status {
      const std::string text = option_text(json);
      if (text != name_in(defaults())) return read(s, text);
      return std::invoke(access, s) = std::invoke(access, defaults()), Status{};
    };
    row.to_json = [name_in](const S& s) { return nlohmann::json(name_in(s)); };
    row.check = [](const S&) { return Status{}; };
    row.default_text = [name_in](const S& s) { return name_in(s) == "none" ? "" : name_in(s); };
    return row;
  }

  /// A switch that turns a setting on, or, when its name begins with "--no-", off.
  template <class Access>
  static Row toggle(std::string_view flag, Access access, std::string help) {
    const bool given = !flag.starts_with("--no-");
    Row row = plain(flag, std::move(help));
    row.read_text = [access, given](S& s, std::string_view) -> Status {
      return std::invoke(access, s) = given, Status{};
    };
    row.read_json = [access, flag = row.flag](S& s, const nlohmann::json& json) -> Status {
      if (!json.is_boolean())
        return fail(ErrorCode::bad_setting, "{}: {} is neither true nor false", flag,
                    json_text(json));
      return std::invoke(access, s) = json.get<bool>(), Status{};
    };
    row.to_json = [access](const S& s) { return nlohmann::json(bool(std::invoke(access, s))); };
    row.check = [](const S&) { return Status{}; };
    row.default_text = [](const S&) { return std::string(); };
    return row;
  }

  /// An option with a notation of its own: `read` is Result<T>(string_view), and `print` makes JSON
  /// of a T, from which option_text() makes a text that `read` understands.
  template <class Access, class Read, class Print>
  static Row text(std::string_view flag, Access access, Read read, Print print, std::string help) {
    Row row = plain(flag, std::move(help));
    row.value = "TEXT";
    row.read_text = [access, read](S& s, std::string_view text) -> Status {
      LUXEL_TRY(std::invoke(access, s), read(text));
      return {};
    };
    row.to_json = [access, print](const S& s) -> nlohmann::json {
      return print(std::invoke(access, s));
    };
    row.read_json = [access, read = row.read_text, to_json = row.to_json](
                        S& s, const nlohmann::json& json) -> Status {
      if (json != to_json(defaults())) return read(s, option_text(json));
      return std::invoke(access, s) = std::invoke(access, defaults()), Status{};
    };
    row.check = [](const S&) { return Status{}; };
    row.default_text = [json = row.to_json](const S& s) {
      const nlohmann::json value = json(s);
      return value.is_null() || value == 0 ? std::string() : option_text(value);
    };
    return row;
  }

 private:
  static Row plain(std::string_view flag, std::string help) {
    Row row;
    row.flag = flag, row.key = key_of(flag), row.help = std::move(help);
    return row;
  }

  template <class T, class Access>
  static Row number_of(std::string_view flag, Access access, Range range, std::string help) {
    constexpr bool optional = is_optional<Value<Access>>::value;
    const auto in_range = [range](T value) {
      return double(value) >= range.low && double(value) <= range.high &&
             !(range.above && double(value) == range.low);
    };
    const auto set = [flag = std::string(flag), access, range, in_range](S& s, T value) -> Status {
      if (!in_range(value)) return out_of_range(flag, fmt::format("{}", value), range);
      return std::invoke(access, s) = value, Status{};
    };
    Row row = plain(flag, std::move(help));
    row.value = "NUMBER";
    if (range.wrong.empty()) row.range = text_of(range);
    // Numbers that T cannot hold, as -1, 2.5, 1e-60 or nan may be, are out of range.
    row.is_of_kind = [](std::string_view text) {
      return is_number(text) || (optional && text == "auto");
    };
    row.read_text = [access, set, range, flag = row.flag](S& s, std::string_view text) -> Status {
      if (optional && text == "auto") return std::invoke(access, s) = Value<Access>{}, Status{};
      if (const auto value = number_from<T>(text)) return set(s, *value);
      if (is_number(text)) return out_of_range(flag, std::string(text), range);
      return not_a_number(flag, text);
    };
    row.read_json = [access, read = row.read_text](S& s, const nlohmann::json& json) -> Status {
      const Value<Access>& by_default = std::invoke(access, defaults());
      // The default need not lie in the range.
      if (json == json_of(by_default)) return std::invoke(access, s) = by_default, Status{};
      if (optional && json == "auto") return std::invoke(access, s) = Value<Access>{}, Status{};
      return read(s, option_text(json));
    };
    row.to_json = [access](const S& s) { return json_of(std::invoke(access, s)); };
    row.check = [access, in_range, range, flag = row.flag](const S& s) -> Status {
      const auto& value = std::invoke(access, s);
      if (value == std::invoke(access, defaults())) return {};
      if constexpr (optional) {
        if (!value || in_range(*value)) return {};
        return out_of_range(flag, fmt::format("{}", *value), range);
      } else {
        if (in_range(value)) return {};
        return out_of_range(flag, fmt::format("{}", value), range);
      }
    };
    row.default_text = [access](const S& s) {
      const nlohmann::json json = json_of(std::invoke(access, s));
      if (json == "auto" || json == 0) return std::string();
      return json.is_number_float() ? fmt::format("{}", json.get<double>()) : json_text(json);
    };
    return row;
  }

  static const S& defaults() {
    static const S settings{};
    return settings;
  }

  template <class T>
  static nlohmann::json json_of(const T& value) {
    if constexpr (is_optional<T>::value)
      return value ? json_of_number(*value) : nlohmann::json("auto");
    else
      return json_of_number(value);
  }
};

}  // namespace luxel::pipeline
