// Options of the command line as keyword arguments: samples=64 is --samples 64.
#pragma once

#include <CLI/App.hpp>
#include <set>
#include <string>

#include "bindings/python/work.h"
#include "luxel/pipeline/settings/option.h"

namespace luxel::python {

/// Parses keyword arguments as `command` parses its options. Names have _ for -; a list stands for
/// values with commas between them, or for an option given several times; True for a switch, and
/// False for the switch that begins with no_; None for an option that is not given. `function` is
/// named in messages. Raises TypeError for what is no option, and ValueError for values.
void parse(CLI::App& command, const py::kwargs& options, const std::string& function);

/// An option as make_stub.py writes it: name, type, help and default.
struct Described {
  std::string name, type, help, default_text;
};
/// An option of a table; a switch's name may begin with no_.
Described describe(const pipeline::OptionText& row, const std::string& default_text);

/// describe() of each flag of a table once, without those of `left_out`.
template <class S>
void describe_all(const pipeline::Options<S>& table, const S& defaults,
                  const std::set<std::string>& left_out, std::vector<Described>& out) {
  std::set<std::string> known = left_out;
  for (const pipeline::Option<S>& row : table)
    if (known.insert(row.flag).second) out.push_back(describe(row, row.default_text(defaults)));
}
/// A list of tuples.
py::list list_of(const std::vector<Described>& options);

}  // namespace luxel::python
