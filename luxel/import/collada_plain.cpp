// A .dae file anew, through pugixml, with values that begin and end without blanks: Assimp reads
// colors and single numbers only where they stand right behind their tag.
#include <pugixml.hpp>

#include <algorithm>
#include <array>
#include <set>
#include <sstream>

#include "luxel/import/text_lines.h"
#include "luxel/import/xml_text.h"

namespace luxel::import {
namespace {

/// A text of numbers that states the places of vertices.
struct Places {
  pugi::xml_text text;
  size_t first = 0, stride = 3;  ///< of x, y and z

  /// x, y or z; 3: none of them.
  size_t axis_of(size_t number) const {
    return number < first ? 3 : std::min<size_t>((number - first) % stride, 3);
  }
};

/// Hands over each number. False at a word that is none.
template <class Take>
bool for_each_number(const Places& places, const Take& take) {
  std::string_view rest = places.text.get();
  for (size_t i = 0, at = 0; (at = rest.find_first_not_of(kXmlBlanks)) != rest.npos; ++i) {
    const size_t end = std::min(rest.find_first_of(kXmlBlanks, at), rest.size());
    const auto number = finite_number<double>(rest.substr(at, end - at));
    if (!number) return false;
    take(i, *number);
    rest.remove_prefix(end);
  }
  return true;
}

/// Those in a source; none where they are not x, y and z in one text.
std::optional<Places> places_in(const pugi::xml_node& source) {
  const pugi::xml_node array = source.child("float_array"),
                       accessor = source.child("technique_common").child("accessor");
  std::string names;
  for (const pugi::xml_node param : accessor.children("param"))
    names += param.attribute("name").value();
  const bool is_one_text = array.first_child() && array.first_child() == array.last_child();
  const auto stride = size_t(accessor.attribute("stride").as_ullong(1));
  if (!is_one_text || stride < 3 || names != "XYZ" ||
      accessor.attribute("source").value() != std::string("#") + array.attribute("id").value())
    return std::nullopt;
  return Places{array.text(), size_t(accessor.attribute("offset").as_ullong(0)), stride};
}

/// The places of all vertices; none where some cannot be told. An array counts once.
std::vector<Places> all_places(const pugi::xml_document& document) {
  std::vector<Places> out;
  std::set<const char*> known;
  for (const pugi::xpath_node& found :
       document.select_nodes("//vertices/input[@semantic='POSITION']")) {
    const std::string id = found.node().attribute("source").value();
    const pugi::xml_node source = found.parent().parent().find_child_by_attribute(
        "source", "id", id.substr(id.starts_with('#')).c_str());
    const std::optional<Places> places = places_in(source);
    if (!places) return {};
    if (known.insert(places->text.get()).second) out.push_back(*places);
  }
  return out;
}

/// Brings vertices that lie far from the origins of their meshes near another one, the same for all
/// meshes.
Status take_origin_off(const pugi::xml_document& document, const SourceFile& source, DVec3& near) {
  std::vector<Places> all = all_places(document);
  DBox3 box;
  size_t numbers = 0;
  for (const Places& places : all) {
    std::array<double, 4> p{};
    const bool are_numbers = for_each_number(places, [&](size_t i, double number) {
      p[places.axis_of(i)] = number, ++numbers;
      if (places.axis_of(i) == 2) box.extend({p[0], p[1], p[2]});
    });
    if (!are_numbers) return {};
  }
  near = origin_for(box);
  if (near == DVec3{}) return {};
  constexpr size_t kLongest = 16;  // of a number in single precision, with a blank
  LUXEL_TRY_STATUS(source.memory.take(kLongest * numbers, "the vertices of " + source.name));
  for (Places& places : all) {
    std::string text;
    const std::array off{near.x, near.y, near.z, 0.0};
    for_each_number(places, [&](size_t i, double number) {
      text += fmt::format("{} ", float(number - off[places.axis_of(i)]));
    });
    places.text.set(text.c_str());
  }
  return {};
}

}  // namespace

Result<std::string> write_plain_collada(const SourceFile& source, DVec3& near) {
  const std::string_view text = text_of(source.bytes);
  // The checks look for the bytes of tags, which pugixml would find in UTF-16 too.
  if (text.find('\0') != text.npos)
    return fail(ErrorCode::bad_input, "{}: it is UTF-16 or damaged; save it as UTF-8", source.name);
  const auto nodes = uint64_t(std::ranges::count(text, '<')),
             attributes = uint64_t(std::ranges::count(text, '='));
  LUXEL_TRY_STATUS(source.memory.take(128 * nodes + 40 * attributes + 3 * text.size(),
                                      "the elements of " + source.name));
  pugi::xml_document document;
  // Comments stay: numbers before and after one that is gone would become one number.
  constexpr unsigned kKeep = pugi::parse_full & ~pugi::parse_declaration;
  const pugi::xml_parse_result parsed =
      document.load_buffer(text.data(), text.size(), kKeep | pugi::parse_trim_pcdata);
  if (!parsed)
    return fail(ErrorCode::bad_input, "{}, line {}: its XML is broken: {}", source.name,
                line_of(text, std::min(size_t(parsed.offset), text.size())),
                one_sentence(parsed.description()));
  LUXEL_TRY_STATUS(take_origin_off(document, source, near));
  std::ostringstream out;
  document.save(out, "", pugi::format_raw | pugi::format_no_declaration, pugi::encoding_utf8);
  return std::move(out).str();
}

}  // namespace luxel::import
