#include <cstdio>

#include <fmt/format.h>

#include "bench/bench.h"
#include "luxel/base/parallel.h"

namespace luxel::bench {

Table new_table(std::string name, std::vector<std::string> columns) {
  return {std::move(name), thread_count(), std::move(columns), {}, {}, nlohmann::json::array()};
}

std::string percent(double share) { return fmt::format("{:.2f} %", 100 * share); }

std::string mib(uint64_t bytes) { return fmt::format("{:.1f}", double(bytes) / double(1u << 20)); }

std::string machine_name() {
  std::string model = "unknown processor";
  if (FILE* file = std::fopen("/proc/cpuinfo", "r")) {
    char line[512];
    while (std::fgets(line, sizeof line, file)) {
      const std::string_view text(line);
      if (!text.starts_with("model name")) continue;
      model = text.substr(text.find(':') + 2);
      model.erase(model.find_last_not_of('\n') + 1);
      break;
    }
    std::fclose(file);
  }
  return model;
}

std::string markdown(const Table& table) {
  std::string text = fmt::format("### luxel bench {}\n\n{}, {} threads\n\n", table.name,
                                 machine_name(), table.threads);
  const auto row = [&](const std::vector<std::string>& cells) {
    for (const std::string& cell : cells) text += "| " + cell + " ";
    text += "|\n";
  };
  row(table.columns);
  row(std::vector<std::string>(table.columns.size(), "---"));
  for (const auto& cells : table.rows) row(cells);
  for (const std::string& note : table.notes) text += "\n" + note + "\n";
  return text;
}

}  // namespace luxel::bench
