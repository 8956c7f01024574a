#include "luxel/import/mtl_text.h"

#include <algorithm>
#include <array>
#include <optional>

#include "luxel/import/text_lines.h"

namespace luxel::import {
namespace {

/// Assimp keeps names of up to 1023 bytes, and drops longer ones.
constexpr size_t kLongestName = 1023;

bool is_name(std::string_view name) {
  return !name.empty() && name.size() <= kLongestName && name.find('\0') == name.npos;
}

/// "Kd 0.5 0.6 0.7"; one number stands for three.
std::string color_line(const char* keyword, std::string_view rest) {
  std::array<float, 3> c{};
  size_t count = 0;
  for (std::string_view word; count < 3 && !(word = next_word(rest)).empty();) {
    const std::optional<float> value = finite_number(word);
    if (!value) break;
    c[count++] = *value;
  }
  if (count == 1) c[1] = c[2] = c[0];
  return count == 1 || count == 3 ? fmt::format("{} {} {} {}\n", keyword, c[0], c[1], c[2])
                                  : std::string();
}

std::string number_line(const char* keyword, std::string_view rest) {
  std::string_view word = next_word(rest);
  if (word == "-halo") word = next_word(rest);
  const std::optional<float> value = finite_number(word);
  return value ? fmt::format("{} {}\n", keyword, *value) : std::string();
}

/// The model's number; Assimp reads it as a whole one.
std::string illumination_line(std::string_view rest) {
  const std::optional<float> value = finite_number(next_word(rest));
  return value && *value >= 0 && *value <= 10 ? fmt::format("illum {}\n", int(*value))
                                              : std::string();
}

/// How many words follow an option of a picture; -o, -s and -t have one to three numbers.
size_t words_after(std::string_view option) {
  if (option == "-mm") return 2;
  return option == "-o" || option == "-s" || option == "-t" ? 3 : 1;
}

/// "map_Kd -clamp on brick.png": of the options -clamp alone changes what is drawn here.
std::string picture_line(const char* keyword, std::string_view rest) {
  bool clamp = false;
  for (std::string_view after = rest;; rest = after) {
    const std::string_view option = next_word(after);
    if (!option.starts_with('-')) break;
    for (size_t left = words_after(option); left > 0; --left) {
      std::string_view next = after;
      const std::string_view word = next_word(next);
      if (words_after(option) == 3 && !finite_number(word)) break;
      if (option == "-clamp") clamp = word == "on";
      after = next;
    }
  }
  const std::string_view name = trimmed(rest);
  if (!is_name(name)) return {};
  return fmt::format("{}{} {}\n", keyword, clamp ? " -clamp on" : "", name);
}

/// A line as Assimp gets it; empty when it is wrong, none when it says nothing that is used.
std::optional<std::string> line_for_assimp(std::string_view line) {
  const std::string word = lower_case(std::string(next_word(line)));
  if (word == "kd") return color_line("Kd", line);
  if (word == "ks") return color_line("Ks", line);
  if (word == "ke") return color_line("Ke", line);
  if (word == "ns") return number_line("Ns", line);
  if (word == "d") return number_line("d", line);
  if (word == "tr") return number_line("Tr", line);
  if (word == "pm") return number_line("Pm", line);
  if (word == "illum") return illumination_line(line);
  if (word == "map_kd") return picture_line("map_Kd", line);
  if (word == "map_ke" || word == "map_emissive") return picture_line("map_Ke", line);
  return std::nullopt;
}

}  // namespace

void add_library(std::string_view text, const std::string& name, MtlText& out,
                 std::vector<std::string>& warnings) {
  std::string material;
  size_t left_out = 0, first = 0;
  for (size_t number = 1; !text.empty(); ++number) {
    std::string_view line = next_line(text);
    std::string_view rest = line;
    if (lower_case(std::string(next_word(rest))) == "newmtl") {
      material = is_name(trimmed(rest)) ? std::string(trimmed(rest)) : std::string();
      if (!material.empty()) out.text += fmt::format("newmtl {}\n", material);
    }
    const std::optional<std::string> said = line_for_assimp(line);
    if (!said) continue;
    if (said->empty() || material.empty()) {
      if (left_out++ == 0) first = number;
      continue;
    }
    out.text += *said;
    if (said->starts_with("Kd")) out.with_color.insert(material);
  }
  if (left_out > 0)
    warnings.push_back(fmt::format(
        "{}: {} left out, the first in line {}: {} no material above or no usable value", name,
        left_out == 1 ? "1 line is" : fmt::format("{} lines are", left_out), first,
        left_out == 1 ? "it has" : "they have"));
}

void add_libraries(std::string_view names, const SourceFile& source, MtlText& out,
                   std::vector<std::string>& warnings) {
  const auto add = [&](std::string_view name) -> Status {
    LUXEL_TRY(
        const std::vector<std::byte> bytes,
        read_named_file(source.files, name, source.name + ": a material file", source.memory));
    add_library(text_of(bytes), std::string(name), out, warnings);
    return {};
  };
  const std::string_view whole = trimmed(names);
  if (whole.empty()) return;
  const Status status = add(whole);
  if (status) return;
  if (whole.find_first_of(kBlank) == whole.npos) {
    warnings.push_back(status.error().message + "; white with a reflectance of 0.8 is used");
    return;
  }
  for (std::string_view word; !(word = next_word(names)).empty();)
    if (const Status one = add(word); !one)
      warnings.push_back(one.error().message + "; white with a reflectance of 0.8 is used");
}

}  // namespace luxel::import
