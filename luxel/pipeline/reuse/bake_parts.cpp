#include "luxel/pipeline/reuse/bake_parts.h"

#include <algorithm>

namespace luxel::pipeline {

namespace fs = std::filesystem;

fs::path parts_file(const BakeSettings& settings) {
  if (settings.part.is_all()) return settings.output / "checkpoint.luxel";
  return settings.output /
         fmt::format("part-{}-of-{}.luxel", settings.part.number, settings.part.of);
}

std::vector<fs::path> part_files_in(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with("part-") && name.ends_with(".luxel")) out.push_back(entry->path());
  }
  std::ranges::sort(out);
  return out;
}

std::vector<fs::path> other_parts(const BakeSettings& settings) {
  if (settings.part.is_all()) return settings.parts;
  std::vector<fs::path> out = part_files_in(settings.output);
  std::erase(out, parts_file(settings));
  return out;
}

}  // namespace luxel::pipeline
