// Output of luxel-view. Nothing else here prints (tools/check_arrows.py): so no text of a file or
// a user reaches a terminal that would obey it.
#pragma once

#include <string_view>

namespace luxel::view_window {

/// A line on stderr: short_message() of the text behind `own`, which is luxel's.
void print_line(std::string_view text, std::string_view own = {});

}  // namespace luxel::view_window
