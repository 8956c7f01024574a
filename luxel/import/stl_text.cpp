// A text .stl file that lies far from its origin, written anew near it: Assimp would round its
// numbers to single precision.
#include "luxel/import/format.h"
#include "luxel/import/readers.h"
#include "luxel/import/text_lines.h"

namespace luxel::import {
namespace {

/// The corner that a line states; none on another line.
std::optional<DVec3> corner_on(std::string_view line) {
  if (next_word(line) != "vertex") return std::nullopt;
  DVec3 p;
  for (double* coordinate : {&p.x, &p.y, &p.z}) {
    const auto number = finite_number<double>(next_word(line));
    if (!number) return std::nullopt;
    *coordinate = *number;
  }
  return p;
}

}  // namespace

Result<std::optional<std::string>> write_near_stl(const SourceFile& source, DVec3& near) {
  const std::string_view text = text_of(source.bytes);
  if (is_binary_stl(text)) return std::nullopt;
  DBox3 box;
  for (std::string_view rest = text; !rest.empty();)
    if (const auto corner = corner_on(next_line(rest))) box.extend(*corner);
  near = origin_for(box);
  if (near == DVec3{}) return std::nullopt;
  LUXEL_TRY_STATUS(source.memory.take(2 * text.size(), "the text of " + source.name));
  std::string out;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view line = next_line(rest);
    if (const auto corner = corner_on(line)) {
      const Vec3 p = to_float(*corner - near);
      out += fmt::format("vertex {} {} {}\n", p.x, p.y, p.z);
    } else {
      out.append(line) += '\n';
    }
  }
  return out;
}

}  // namespace luxel::import
