#include "apps/cli/print.h"

#include <nlohmann/json.hpp>

#include "luxel/base/shown_text.h"

namespace luxel::cli {
namespace {

void write(std::FILE* to, std::string_view text) { std::fwrite(text.data(), 1, text.size(), to); }

}  // namespace

void print_line(std::FILE* to, std::string_view text, std::string_view own) {
  // In one piece: lines of several processes do not mix then.
  write(to, std::string(own) + short_message(text) + "\n");
}

void print_own(std::FILE* to, std::string_view text) { write(to, text); }

void print_bytes(std::FILE* to, std::span<const std::byte> bytes) {
  std::fwrite(bytes.data(), 1, bytes.size(), to);
}

void print_json(std::FILE* to, const nlohmann::json& json, int indent) {
  write(to, json_text(json, indent) + "\n");
}

void rewrite_line(std::string_view text) {
  write(stderr, "\r\033[K" + short_message(text));
  std::fflush(stderr);
}

}  // namespace luxel::cli
