#include "bindings/python/options.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <string_view>

#include "luxel/arguments/near_miss.h"

namespace luxel::python {
namespace {

std::string with(std::string text, char from, char to) {
  std::ranges::replace(text, from, to);
  return text;
}

std::string name_of(const std::string& flag) {
  return with(flag.substr(flag.find_first_not_of('-')), '-', '_');
}

bool is_switch(const CLI::Option& option) { return option.get_items_expected_max() == 0; }

bool is_list(const py::handle& value) {
  return PySequence_Check(value.ptr()) != 0 && !py::isinstance<py::str>(value) &&
         !py::isinstance<py::bytes>(value);
}

/// A number, a text or a path as the command line has it. A whole number may be a float.
std::string text_of_one(const std::string& key, const py::handle& value) {
  if (is_list(value)) throw py::type_error(key + " must not hold lists within lists");
  if (py::isinstance<py::bytes>(value))
    throw py::type_error(key + " must be text or a path, not bytes");
  if (PyFloat_Check(value.ptr()) && value.attr("is_integer")().cast<bool>())
    return py::str(py::int_(py::reinterpret_borrow<py::object>(value))).cast<std::string>();
  const auto text = py::str(value).cast<std::string>();
  if (text.empty() || text.find('\0') != text.npos)
    throw py::value_error(key + " needs a value; None stands for none");
  return text;
}

/// text_of_one(); of a list all, with commas.
std::string text_of(const std::string& key, const py::handle& value) {
  if (!is_list(value)) return text_of_one(key, value);
  std::string out;
  for (const py::handle& one : value) out += (out.empty() ? "" : ",") + text_of_one(key, one);
  if (out.empty()) throw py::value_error(key + " needs a value; None stands for none");
  return out;
}

/// Python's own truth values, and numpy's.
bool is_truth(const py::handle& value) {
  return py::isinstance<py::bool_>(value) ||
         std::string_view(Py_TYPE(value.ptr())->tp_name) == "numpy.bool_";
}

[[noreturn]] void raise_unknown(const CLI::App& command, const std::string& function,
                                const std::string& key) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    names.push_back(name_of(option->get_name()));
  throw py::type_error(function + "() has no option '" + key + "'" +
                       arguments::did_you_mean(key, names));
}

/// "--samples=64" for samples=64.
void add_arguments(const CLI::App& command, const std::string& function, const std::string& key,
                   const py::handle& value, std::vector<std::string>& out) {
  const std::string dashed = with(key, '_', '-');
  const CLI::Option* option = command.get_option_no_throw("--" + dashed);
  const CLI::Option* off = command.get_option_no_throw("--no-" + dashed);
  if (!option && !off) raise_unknown(command, function, key);
  if (value.is_none()) return;
  const bool takes_value = option && !is_switch(*option);
  if (takes_value == is_truth(value))
    throw py::type_error(key + (takes_value ? " needs a value" : " must be True or False"));
  if (!takes_value) {
    const bool is_on = py::bool_(py::reinterpret_borrow<py::object>(value));
    if (is_on && option) out.push_back("--" + dashed);
    if (!is_on && off) out.push_back("--no-" + dashed);
  } else if (is_list(value) && option->get_items_expected_max() > 1) {
    for (const py::handle& one : value) out.push_back("--" + dashed + "=" + text_of_one(key, one));
  } else {
    out.push_back("--" + dashed + "=" + text_of(key, value));
  }
}

}  // namespace

void parse(CLI::App& command, const py::kwargs& options, const std::string& function) {
  std::vector<std::string> arguments;
  for (const auto& [key, value] : options)
    add_arguments(command, function, key.cast<std::string>(), value, arguments);
  std::ranges::reverse(arguments);  // CLI11 takes them from the back
  try {
    command.parse(std::move(arguments));
  } catch (const CLI::ParseError& error) {
    throw py::value_error(error.what());
  }
}

Described describe(const pipeline::OptionText& row, const std::string& default_text) {
  const bool is_off = row.value.empty() && row.flag.starts_with("--no-");
  const std::string note = row.range.empty() ? "" : " (" + row.range + ")";
  const std::string type = row.value.empty()           ? "bool"
                           : row.is_of_kind("letters") ? (row.repeats ? "Values" : "Value")
                           : row.is_of_kind("0.5")     ? "float"
                                                       : "int";
  std::string name = name_of(row.flag), help = row.help + note, usual = default_text;
  if (is_off) name = name.substr(3), help = "False: " + help, usual = "True";
  return {name, type, help, usual};
}

py::list list_of(const std::vector<Described>& options) {
  py::list out;
  for (const Described& o : options)
    out.append(py::make_tuple(o.name, o.type, o.help, o.default_text));
  return out;
}

}  // namespace luxel::python
