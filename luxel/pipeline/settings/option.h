// An option of a command: one row of a table, from which come the command line, --help, the checks
// of its value, its JSON in bake.json and back, and which checkpoints it fits. The rows are built
// by luxel/pipeline/settings/option_rows.h.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/pipeline/settings/capabilities.h"

namespace luxel::pipeline {

/// Results that another value of an option changes: they decide what a bake can continue from.
enum class Changes : uint8_t {
  light,    ///< the light itself: neither a checkpoint nor a kept bake of another value fits
  scene,    ///< the scene, and digests of the scene tell how
  results,  ///< files made of the light: a kept bake fits, a checkpoint does not
  nothing   ///< no bit of the results: files besides, memory, threads
};

/// An option as its user sees it.
struct OptionText {
  std::string flag;    ///< "--samples", or "--no-stitch" for a switch that turns a setting off
  std::string key;     ///< in bake.json's settings; empty: it is not there
  std::string help;    ///< a sentence without a full stop
  std::string value;   ///< placeholder of the value in --help; empty: the option takes none
  std::string range;   ///< the allowed values, as --help says them; empty: any
  std::string group;   ///< a heading in --help; empty: the first
  std::string solver;  ///< the one solver that has this option; empty: by `needs`
  bool Capabilities::*needs = nullptr;  ///< the solvers that look at it have this; null: all do
  bool refused_without = false;  ///< solvers without it refuse the option, and do not ignore it
  Changes changes = Changes::light;
  bool repeats = false;               ///< may be given several times
  std::vector<std::string> not_with;  ///< flags that contradict it
  /// True: the text is of the option's kind. "abc" is no number. The range is not checked.
  std::function<bool(std::string_view)> is_of_kind = [](std::string_view) { return true; };
};

/// `S`: the struct of settings that has the option's value. All functions are there in every row.
template <class S>
struct Option : OptionText {
  /// Reads the value from the command line; takes any text where `value` is empty. Errors
  /// (bad_setting): the text means nothing, or is out of range.
  std::function<Status(S&, std::string_view)> read_text;
  /// Reads what to_json wrote. Errors (bad_setting).
  std::function<Status(S&, const nlohmann::json&)> read_json;
  /// Null: nothing is set, and bake.json has no such key.
  std::function<nlohmann::json(const S&)> to_json;
  /// The value, whoever has set it. Errors (bad_setting): out of range.
  std::function<Status(const S&)> check;
  /// As --help shows it; empty: none.
  std::function<std::string(const S&)> default_text;

  // Additions to a new row: Option::number(...).unit("METRES").key_is("probe_spacing_m").
  Option key_is(std::string text) && { return key = std::move(text), std::move(*this); }
  Option unit(std::string text) && { return value = std::move(text), std::move(*this); }
  Option only(bool Capabilities::*capability) && { return needs = capability, std::move(*this); }
  Option never_without(bool Capabilities::*capability) && {
    return needs = capability, refused_without = true, std::move(*this);
  }
  Option leaves(Changes what) && { return changes = what, std::move(*this); }
  Option never_with(std::vector<std::string> flags) && {
    return not_with = std::move(flags), std::move(*this);
  }
};

template <class S>
using Options = std::vector<Option<S>>;

/// `options` of a part of the settings as options of the whole; `part` finds the part in it.
template <class S, class Part>
Options<S> options_of_part(const Options<Part>& options, std::function<Part&(S&)> part) {
  Options<S> out;
  const auto of = [part](const S& s) -> const Part& { return part(const_cast<S&>(s)); };
  for (const Option<Part>& o : options) {
    Option<S> lifted;
    static_cast<OptionText&>(lifted) = o;
    lifted.read_text = [o, part](S& s, std::string_view text) {
      return o.read_text(part(s), text);
    };
    lifted.read_json = [o, part](S& s, const nlohmann::json& j) { return o.read_json(part(s), j); };
    lifted.to_json = [o, of](const S& s) { return o.to_json(of(s)); };
    lifted.check = [o, of](const S& s) { return o.check(of(s)); };
    lifted.default_text = [o, of](const S& s) { return o.default_text(of(s)); };
    out.push_back(std::move(lifted));
  }
  return out;
}

/// Every row's check(). Errors (bad_setting): the first that fails.
template <class S>
Status check_all(const Options<S>& options, const S& settings) {
  for (const Option<S>& option : options) LUXEL_TRY_STATUS(option.check(settings));
  return {};
}

/// The error (bad_setting) of an option that would have no effect: `user` ("--solver matrix") does
/// not look at `flag`, and `users` do. `advice`: what else to do about it.
Failure not_used(std::string_view user, std::string_view flag, std::string_view users,
                 std::string_view advice = "");

/// "--a, --b and --c".
template <class S>
std::string flags_of(const Options<S>& options) {
  std::string out;
  for (size_t i = 0; i < options.size(); ++i)
    out += (i == 0 ? "" : i + 1 == options.size() ? " and " : ", ") + options[i].flag;
  return out;
}

}  // namespace luxel::pipeline
