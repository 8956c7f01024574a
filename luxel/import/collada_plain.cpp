// A .dae file anew, through pugixml, with values that begin and end without blanks: Assimp reads
// colors and single numbers only where they stand right behind their tag.
#include <pugixml.hpp>

#include <algorithm>
#include <sstream>

#include "luxel/import/text_lines.h"
#include "luxel/import/xml_text.h"

namespace luxel::import {

Result<std::string> write_plain_collada(const SourceFile& source) {
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
  std::ostringstream out;
  document.save(out, "", pugi::format_raw | pugi::format_no_declaration, pugi::encoding_utf8);
  return std::move(out).str();
}

}  // namespace luxel::import
