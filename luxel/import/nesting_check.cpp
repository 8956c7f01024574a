// Depth, before Assimp gets a file: its readers call themselves for what lies in each other, and a
// stack that overflows ends the process.
#include "luxel/import/nesting.h"

#include <algorithm>

#include "luxel/import/text_lines.h"
#include "luxel/import/xml_text.h"

namespace luxel::import {

Status check_nesting(const SourceFile& source) {
  const std::string_view text = text_of(source.bytes);
  size_t depth = 0, at = 0;
  while (const auto tag = next_tag(text, at)) {
    at = tag->end();
    if (tag->opens && !tag->closes && ++depth > kDeepestNesting)
      return fail(ErrorCode::bad_input, "{}, line {}: more than {} elements are nested",
                  source.name, line_of(text, tag->at), kDeepestNesting);
    if (tag->closes && !tag->opens && depth > 0) --depth;
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
