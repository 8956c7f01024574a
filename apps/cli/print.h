// Output of the commands, on a terminal or into a file. Nothing else here prints
// (tools/check_arrows.py): so no text of a file or a user reaches a terminal that would obey it.
#pragma once

#include <cstdio>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string_view>

namespace luxel::cli {

/// One line: short_message() of the text behind `own`, which is luxel's and may have colours.
void print_line(std::FILE* to, std::string_view text, std::string_view own = {});
/// Text of luxel's own alone, with its line breaks, such as a table.
void print_own(std::FILE* to, std::string_view text);
/// Valid JSON in any case (json_text()), and a line break.
void print_json(std::FILE* to, const nlohmann::json& json, int indent = 2);
/// A file for another program.
void print_bytes(std::FILE* to, std::span<const std::byte> bytes);
/// The text in the place of the line on which the cursor of stderr, a terminal, stands.
void rewrite_line(std::string_view text);

}  // namespace luxel::cli
