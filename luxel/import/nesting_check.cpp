// Depth, before Assimp gets a file: its readers call themselves for what lies in each other, and a
// stack that overflows ends the process.
#include "luxel/import/nesting.h"

#include <algorithm>
#include <array>

#include "luxel/import/text_lines.h"
#include "luxel/import/xml_text.h"

namespace luxel::import {
namespace {

Failure too_deep(const SourceFile& source, size_t at, const char* what) {
  return fail(ErrorCode::bad_input, "{}, line {}: more than {} {} are nested", source.name,
              line_of(text_of(source.bytes), at), kDeepestNesting, what);
}

Status check_elements(const SourceFile& source) {
  const std::string_view text = text_of(source.bytes);
  size_t depth = 0, at = 0;
  while (const auto tag = next_tag(text, at)) {
    at = tag->end();
    if (tag->opens && !tag->closes && ++depth > kDeepestNesting)
      return too_deep(source, tag->at, "elements");
    if (tag->closes && !tag->opens && depth > 0) --depth;
  }
  return {};
}

/// Brackets in quotes do not count.
Status check_brackets(const SourceFile& source, const char* pair, char quote) {
  const std::string_view text = text_of(source.bytes);
  const std::array<char, 3> marks{pair[0], pair[1], quote};
  size_t depth = 0;
  for (size_t at = 0; (at = text.find_first_of({marks.data(), 3}, at)) != text.npos; ++at) {
    if (text[at] == quote) {
      at = text.find_first_of(std::string{quote, '\n'}, at + 1);
      if (at == text.npos) break;
    } else if (text[at] == pair[1]) {
      depth -= depth > 0;
    } else if (++depth > kDeepestNesting) {
      return too_deep(source, at, "brackets");
    }
  }
  return {};
}

/// An object of an .ac file says how many objects follow that are its own: `kids 2`.
Status check_kids(const SourceFile& source) {
  const std::string_view text = text_of(source.bytes);
  std::vector<uint64_t> to_come;  // of each open object
  for (std::string_view rest = text; !rest.empty();) {
    const size_t at = text.size() - rest.size();
    std::string_view line = next_line(rest);
    if (next_word(line) != "kids") continue;
    const std::string_view word = next_word(line);
    uint64_t kids = 0;
    std::from_chars(word.data(), word.data() + word.size(), kids);
    if (kids > 0) to_come.push_back(kids);
    if (to_come.size() > kDeepestNesting) return too_deep(source, at, "objects");
    if (kids > 0) continue;
    while (!to_come.empty() && --to_come.back() == 0) to_come.pop_back();
  }
  return {};
}

/// Items of an .lws file each name a parent, so that a chain of them may be as long as the list.
/// Assimp follows chains by calling itself, and looks through all items for each. The list is
/// bounded, not the chains: no scene has so many.
Status check_parents(const SourceFile& source) {
  constexpr size_t kMostParents = 4000;
  const std::string_view text = text_of(source.bytes);
  size_t parents = 0;
  for (size_t at = 0; (at = text.find("ParentItem", at)) != text.npos; ++at)
    if (++parents > kMostParents)
      return fail(ErrorCode::bad_input, "{}, line {}: more than {} items have a parent",
                  source.name, line_of(text, at), kMostParents);
  return {};
}

}  // namespace

Status check_nesting(const SourceFile& source) {
  const auto is_one_of = [&](std::initializer_list<std::string_view> extensions) {
    return std::find(extensions.begin(), extensions.end(), source.extension) != extensions.end();
  };
  if (is_one_of({".dae", ".model", ".xgl", ".irr", ".irrmesh", ".amf", ".xml"}))
    return check_elements(source);
  if (is_one_of({".ase", ".ask", ".bvh", ".ogex"})) return check_brackets(source, "{}", '"');
  if (is_one_of({".ifc", ".step", ".stp"})) return check_brackets(source, "()", '\'');
  if (is_one_of({".ac", ".ac3d", ".acc"})) return check_kids(source);
  if (is_one_of({".lws", ".mot"})) {
    LUXEL_TRY_STATUS(check_brackets(source, "{}", '"'));
    return check_parents(source);
  }
  return {};
}

std::optional<WrongNesting> wrong_nesting(const std::vector<std::vector<uint32_t>>& parts) {
  struct Visit {
    uint32_t part;
    size_t next = 0;
  };
  enum class State : uint8_t { unseen, open, done };
  std::vector<State> states(parts.size(), State::unseen);
  // With copies: how deep each part is, itself included, and how many parts it is.
  std::vector<uint64_t> depths(parts.size(), 1), counts(parts.size(), 1);
  const uint64_t most = std::max<uint64_t>(kMostCopies, parts.size());
  std::vector<Visit> path{{0}};
  states[0] = State::open;
  while (!path.empty()) {
    const auto [part, next] = path.back();
    if (next < parts[part].size()) {
      ++path.back().next;
      const uint32_t held = parts[part][next];
      if (states[held] == State::open) return WrongNesting{held, "holds itself"};
      if (states[held] == State::unseen) {
        states[held] = State::open;
        path.push_back({held});
      }
      continue;
    }
    for (const uint32_t held : parts[part]) {
      depths[part] = std::max(depths[part], depths[held] + 1);
      counts[part] += counts[held];
      if (counts[part] > most)
        return WrongNesting{part, fmt::format("holds more than {} others, counting copies", most)};
    }
    if (depths[part] > kDeepestNesting + 1)
      return WrongNesting{part, fmt::format("holds more than {} nested others", kDeepestNesting)};
    states[part] = State::done;
    path.pop_back();
  }
  return std::nullopt;
}

}  // namespace luxel::import
