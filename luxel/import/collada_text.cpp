// The lenses of a .dae file's cameras, looked up in its text: Assimp keeps only a horizontal angle
// and loses a camera that states its vertical one alone, or is orthographic.
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>

#include "luxel/import/assimp_parts.h"
#include "luxel/import/xml_text.h"

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

}  // namespace

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
