#include "luxel/import/mtl.h"

#include <algorithm>
#include <array>

#include "luxel/import/text_lines.h"

namespace luxel::import {
namespace {

bool read_color(std::string_view rest, Rgb& out) {
  std::array<float, 3> c{};
  size_t count = 0;
  for (std::string_view word; count < 3 && !(word = next_word(rest)).empty();) {
    const std::optional<float> value = finite_number(word);
    if (!value) break;
    c[count++] = *value;
  }
  if (count == 1) c[1] = c[2] = c[0];  // one number stands for three
  if (count != 1 && count != 3) return false;
  out = {c[0], c[1], c[2]};
  return true;
}

bool read_number(std::string_view rest, float& out) {
  std::string_view word = next_word(rest);
  if (word == "-halo") word = next_word(rest);
  const std::optional<float> value = finite_number(word);
  if (value) out = *value;
  return value.has_value();
}

/// The most words that follow an option of a picture; -o, -s and -t have one to three numbers.
size_t words_after(std::string_view option) {
  if (option == "-mm") return 2;
  return option == "-o" || option == "-s" || option == "-t" ? 3 : 1;
}

/// Takes the words of an option off the line.
void read_option(std::string_view option, std::string_view& rest, MtlPicture& out) {
  size_t count = 0;
  for (const size_t most = words_after(option); count < most; ++count) {
    std::string_view after = rest;
    const std::string_view word = next_word(after);
    const std::optional<float> value = finite_number(word);
    if (most == 3 && !value) break;
    if (option == "-clamp") out.clamp = word == "on";
    Vec2* const pair = option == "-s" ? &out.scale : option == "-o" ? &out.offset : nullptr;
    if (pair != nullptr && count < 2) (count == 0 ? pair->x : pair->y) = *value;
    rest = after;
  }
}

/// "map_Kd -clamp on -s 2 2 my brick.png"
bool read_picture(std::string_view rest, MtlPicture& out) {
  MtlPicture picture;
  for (std::string_view after = rest;; rest = after) {
    const std::string_view option = next_word(after);
    if (!option.starts_with('-')) break;
    read_option(option, after, picture);
  }
  picture.name = without_quotes(trimmed(rest));
  if (picture.name.empty() || picture.name.find('\0') != std::string::npos) return false;
  out = picture;
  return true;
}

/// False where the line is wrong; none when it says nothing that is used.
std::optional<bool> read_line(std::string_view keyword, std::string_view rest, MtlMaterial& out) {
  Rgb color;
  if (keyword == "kd") {
    if (!read_color(rest, color)) return false;
    out.color = color;
    return true;
  }
  if (keyword == "tr") {
    float transparent = 0;
    if (!read_number(rest, transparent)) return false;
    out.alpha = 1 - transparent;
    return true;
  }
  if (keyword == "ks") return read_color(rest, out.specular);
  if (keyword == "ke") return read_color(rest, out.emission);
  if (keyword == "ns") return read_number(rest, out.sharpness);
  if (keyword == "d") return read_number(rest, out.alpha);
  if (keyword == "pm") return read_number(rest, out.metallic);
  if (keyword == "map_kd") return read_picture(rest, out.color_picture);
  if (keyword == "map_ke" || keyword == "map_emissive")
    return read_picture(rest, out.emission_picture);
  return std::nullopt;
}

}  // namespace

void add_library(std::string_view text, const std::string& name, MtlLibrary& out,
                 std::vector<std::string>& warnings) {
  MtlMaterial nothing;  // for lines above the first material
  MtlMaterial* material = nullptr;
  size_t left_out = 0, first = 0;
  for (ObjLine line; next_obj_line(text, line);) {
    std::string_view rest = line.text;
    const std::string keyword = lower_case(std::string(next_word(rest)));
    if (keyword == "newmtl") {
      const std::string_view its_name = without_quotes(trimmed(rest));
      material = its_name.empty() ? nullptr : &(out[std::string(its_name)] = MtlMaterial{});
    }
    const std::optional<bool> right =
        read_line(keyword, rest, material != nullptr ? *material : nothing);
    if (!right || (*right && material != nullptr)) continue;
    if (left_out++ == 0) first = line.number;
  }
  if (left_out > 0)
    warnings.push_back(fmt::format(
        "{}: {} left out, the first in line {}: {} no material above or no usable value", name,
        left_out == 1 ? "1 line is" : fmt::format("{} lines are", left_out), first,
        left_out == 1 ? "it has" : "they have"));
}

void add_libraries(std::string_view names, const SourceFile& source, MtlLibrary& out,
                   std::vector<std::string>& warnings) {
  const auto add = [&](std::string_view name) -> Status {
    LUXEL_TRY(
        const std::vector<std::byte> bytes,
        read_named_file(source.files, name, source.name + ": a material file", source.memory));
    // A name of one letter makes a material.
    LUXEL_TRY_STATUS(source.memory.take(40 * bytes.size(), "the materials of " + source.name));
    add_library(text_of(bytes), std::string(name), out, warnings);
    return {};
  };
  const std::string_view whole = without_quotes(trimmed(names));
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
