// What is looked up in the text of a .dae itself. The lenses of its cameras: Assimp keeps only a
// horizontal angle and loses a camera that states its vertical one alone, or is orthographic. And
// the sizes of its lists, which Assimp trusts.
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>

#include "luxel/import/assimp_parts.h"

namespace luxel::import {
namespace {

/// The text of the next element of this name in `text`, its tag included, and all before it and it
/// taken off; none when there is none.
std::optional<std::string_view> next_element(std::string_view& text, std::string_view name) {
  const std::string open = fmt::format("<{}", name), close = fmt::format("</{}>", name);
  for (size_t at = 0; (at = text.find(open, at)) != text.npos; at += open.size()) {
    const size_t after = at + open.size();
    if (after >= text.size() ||
        std::string_view(" \t\r\n>/").find(text[after]) == std::string_view::npos)
      continue;
    const size_t tag_end = std::min(text.find('>', after), text.size() - 1) + 1;
    size_t end = tag_end;
    if (text[tag_end - 2] != '/') end = std::min(text.find(close, tag_end), text.size());
    const std::string_view element = text.substr(at, end - at);
    text.remove_prefix(end);
    return element;
  }
  return std::nullopt;
}

constexpr std::string_view kBlanks = " \t\r\n";

/// The value of an attribute of the element's own tag; empty without one.
std::string_view attribute(std::string_view element, std::string_view name) {
  const std::string_view tag = element.substr(0, element.find('>'));
  for (size_t at = 0; (at = tag.find(name, at + 1)) != tag.npos;) {
    if (kBlanks.find(tag[at - 1]) == kBlanks.npos) continue;
    const size_t equals = tag.find_first_not_of(kBlanks, at + name.size());
    if (equals == tag.npos || tag[equals] != '=') continue;
    const size_t quote = tag.find_first_not_of(kBlanks, equals + 1);
    if (quote == tag.npos) return {};
    const size_t end = tag.find(tag[quote], quote + 1);
    return end == tag.npos ? std::string_view() : tag.substr(quote + 1, end - quote - 1);
  }
  return {};
}

/// The number in a child element; 0 when it is missing or no number.
float child_number(std::string_view element, std::string_view name) {
  const auto child = next_element(element, name);
  if (!child) return 0;
  std::string_view word = child->substr(child->find('>') + 1);
  word.remove_prefix(std::min(word.find_first_not_of(" \t\r\n"), word.size()));
  float value = 0;
  std::from_chars(word.data(), word.data() + word.size(), value);
  return std::isfinite(value) ? value : 0;
}

float half_tangent(float angle_deg) {
  return angle_deg > 0 && angle_deg < 180 ? std::tan(angle_deg * kPi / 360) : 0;
}

/// A lens states one or two of width, height and their ratio. Returns half the height (0: not
/// known) and the ratio (0: that of the picture).
std::pair<float, float> height_and_aspect(float half_width, float half_height, float aspect) {
  if (half_width > 0 && half_height > 0) aspect = half_width / half_height;
  if (half_height <= 0) half_height = aspect > 0 ? half_width / aspect : half_width;
  return {half_height, std::max(aspect, 0.0f)};
}

ColladaLens lens_of(std::string_view camera) {
  ColladaLens lens;
  const float ratio = child_number(camera, "aspect_ratio");
  std::string_view rest = camera;
  if (const auto ortho = next_element(rest, "orthographic")) {
    const auto [half, aspect] =
        height_and_aspect(child_number(*ortho, "xmag"), child_number(*ortho, "ymag"), ratio);
    lens.orthographic_height = 2 * half;
    lens.aspect = aspect;
    return lens;
  }
  const auto [half, aspect] = height_and_aspect(half_tangent(child_number(camera, "xfov")),
                                                half_tangent(child_number(camera, "yfov")), ratio);
  lens.fov_y_rad = 2 * std::atan(half);
  lens.aspect = aspect;
  return lens;
}

/// A whole number in an attribute; `otherwise` when the attribute is missing, none when it is
/// wrong.
std::optional<uint64_t> attribute_number(std::string_view element, std::string_view name,
                                         uint64_t otherwise) {
  const std::string_view word = attribute(element, name);
  if (word.empty()) return otherwise;
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  // 32 bits, as in Assimp, so that their products fit into 64.
  if (error != std::errc() || end != word.data() + word.size() || value > UINT32_MAX) return {};
  return value;
}

uint64_t params_of(std::string_view accessor) {
  uint64_t count = 0;
  accessor.remove_prefix(std::min(accessor.find('>'), accessor.size()));
  while (next_element(accessor, "param")) ++count;
  return count;
}

}  // namespace

Status check_collada(const SourceFile& source) {
  const std::string_view text(reinterpret_cast<const char*>(source.bytes.data()),
                              source.bytes.size());
  std::map<std::string_view, uint64_t> sizes;
  std::string_view rest = text;
  while (const auto array = next_element(rest, "float_array"))
    sizes[attribute(*array, "id")] = attribute_number(*array, "count", 0).value_or(0);
  rest = text;
  while (const auto accessor = next_element(rest, "accessor")) {
    std::string_view id = attribute(*accessor, "source");
    if (id.starts_with('#')) id.remove_prefix(1);
    const auto size = sizes.find(id);
    if (size == sizes.end()) continue;  // of names, in skins
    const auto count = attribute_number(*accessor, "count", 0),
               stride = attribute_number(*accessor, "stride", 1),
               offset = attribute_number(*accessor, "offset", 0);
    // Each of `count` entries begins a stride after the one before and has one number per param.
    const uint64_t entry = std::max(params_of(*accessor), stride.value_or(0));
    if (!count || !stride || !offset || *offset > size->second ||
        (*count > 0 && *offset + (*count - 1) * *stride + entry > size->second))
      return fail(ErrorCode::bad_input,
                  "{}: an accessor reads past the float_array '{}', which holds {} numbers",
                  source.name, id, size->second);
  }
  return {};
}

std::vector<ColladaLens> read_collada_lenses(const SourceFile& source) {
  const std::string_view text(reinterpret_cast<const char*>(source.bytes.data()),
                              source.bytes.size());
  std::map<std::string_view, ColladaLens> by_id;
  std::string_view rest = text;
  while (const auto camera = next_element(rest, "camera"))
    by_id[attribute(*camera, "id")] = lens_of(*camera);
  std::vector<ColladaLens> lenses;
  rest = text;
  while (const auto instance = next_element(rest, "instance_camera")) {
    std::string_view url = attribute(*instance, "url");
    if (url.starts_with('#')) url.remove_prefix(1);
    if (const auto found = by_id.find(url); found != by_id.end()) lenses.push_back(found->second);
  }
  return lenses;
}

}  // namespace luxel::import
