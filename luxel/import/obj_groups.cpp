#include "luxel/import/obj_groups.h"

#include <charconv>
#include <map>

#include "luxel/import/text_lines.h"

namespace luxel::import {
namespace {

constexpr std::string_view kPrefix = "luxel-group-";

}  // namespace

ObjGroups number_groups(const SourceFile& source) {
  ObjGroups groups;
  std::map<std::pair<std::string, std::string>, size_t> numbers;  // of (o, g)
  std::string object, group;
  groups.text.reserve(source.bytes.size());
  for (std::string_view text = text_of(source.bytes); !text.empty();) {
    const std::string_view line = next_line(text);
    std::string_view rest = line;
    const std::string_view word = next_word(rest);
    if (word == "mtllib") {
      groups.text += '\n';
      continue;
    }
    if (word != "o" && word != "g") {
      groups.text.append(line).append("\n");
      continue;
    }
    if (word == "o") object = trimmed(rest);
    group = word == "g" ? trimmed(rest) : std::string_view();
    const auto [at, is_new] = numbers.try_emplace({object, group}, groups.names.size());
    if (is_new) groups.names.push_back(group.empty() ? object : group);
    groups.text += fmt::format("g {}{}\n", kPrefix, at->second);
  }
  return groups;
}

std::string name_of_group(const ObjGroups& groups, const std::string& numbered) {
  if (!numbered.starts_with(kPrefix)) return numbered;
  size_t number = groups.names.size();
  std::from_chars(numbered.data() + kPrefix.size(), numbered.data() + numbered.size(), number);
  return number < groups.names.size() ? groups.names[number] : numbered;
}

}  // namespace luxel::import
