#include "apps/view/print.h"

#include <cstdio>

#include "luxel/base/shown_text.h"

namespace luxel::view_window {

void print_line(std::string_view text, std::string_view own) {
  const std::string line = std::string(own) + short_message(text) + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}

}  // namespace luxel::view_window
