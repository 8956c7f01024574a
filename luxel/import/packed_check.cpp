// Scenes in archives, before Assimp gets them: what they hold is checked as it would be alone.
#include <cstdlib>
#include <map>

#include "luxel/import/nesting.h"
#include "luxel/import/text_lines.h"
#include "luxel/import/unzip.h"
#include "luxel/import/xml_text.h"

namespace luxel::import {
namespace {

/// The objects of a .3mf file's model, which hold others. Part 0 is what is to be built.
struct PrintedObjects {
  std::vector<std::vector<uint32_t>> parts{1};
  std::vector<size_t> at{0};
  std::map<long, uint32_t> number;  // of an id

  uint32_t of(std::string_view id) {
    const auto [found, is_new] =
        number.try_emplace(std::strtol(std::string(id).c_str(), nullptr, 10), uint32_t(at.size()));
    if (is_new) parts.emplace_back(), at.push_back(0);
    return found->second;
  }
};

Status check_printed(const SourceFile& source) {
  const std::string_view text = text_of(source.bytes);
  PrintedObjects objects;
  uint32_t open = 0;
  size_t at = 0;
  while (const auto tag = next_tag(text, at)) {
    at = tag->end();
    if (!tag->opens) continue;
    if (tag->name == "object") {
      open = objects.of(attribute(tag->text, "id"));
      objects.at[open] = tag->at;
    }
    if (tag->name != "component" && tag->name != "item") continue;
    const uint32_t held = objects.of(attribute(tag->text, "objectid"));
    objects.parts[tag->name == "item" ? 0 : open].push_back(held);
  }
  const auto wrong = wrong_nesting(objects.parts);
  if (!wrong) return {};
  return fail(ErrorCode::bad_input, "{}, line {}: the object there {}", source.name,
              line_of(text, objects.at[wrong->part]), wrong->what);
}

Status check_inner(SourceFile inner) {
  LUXEL_TRY_STATUS(check_nesting(inner));
  if (inner.extension == ".dae") return check_collada(inner);
  if (inner.extension == ".model") return check_printed(inner);
  return {};
}

SourceFile inner_file(const SourceFile& source, std::string name, std::string extension,
                      std::vector<std::byte> bytes) {
  SourceFile inner = source;
  inner.name += std::move(name);
  inner.extension = std::move(extension);
  inner.bytes = std::move(bytes);
  return inner;
}

}  // namespace

Status check_packed(const SourceFile& source) {
  if (source.extension == ".zgl") {
    // Assimp steps over two bytes, whatever they are.
    const size_t start = std::min<size_t>(source.bytes.size(), 2);
    return check_inner(
        inner_file(source, "", ".xgl", inflate_all(std::span(source.bytes).subspan(start))));
  }
  // The names of the files in an archive are not fixed; what each kind begins with is.
  struct Kind {
    std::string_view archive, mark, extension;
  };
  constexpr Kind kKinds[] = {{".zae", "<COLLADA", ".dae"},
                             {".3mf", "<model", ".model"},
                             {".ifczip", "ISO-10303-21", ".ifc"}};
  for (const Kind& kind : kKinds) {
    if (kind.archive != source.extension) continue;
    LUXEL_TRY(std::vector<PackedFile> files, unzip(source));
    for (PackedFile& file : files) {
      if (text_of(file.bytes).find(kind.mark) == std::string_view::npos) continue;
      LUXEL_TRY_STATUS(check_inner(inner_file(source, fmt::format(", {}", file.name),
                                              std::string(kind.extension), std::move(file.bytes))));
    }
  }
  return {};
}

}  // namespace luxel::import
