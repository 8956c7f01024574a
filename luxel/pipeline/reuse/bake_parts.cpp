#include "luxel/pipeline/reuse/bake_parts.h"

#include <algorithm>

namespace luxel::pipeline {

namespace fs = std::filesystem;

namespace {

/// Files in a folder whose names begin and end so, by name.
std::vector<fs::path> files_named(const fs::path& folder, std::string_view begin,
                                  std::string_view end) {
  std::vector<fs::path> out;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), last; !error && entry != last;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(begin) && name.ends_with(end)) out.push_back(entry->path());
  }
  std::ranges::sort(out);
  return out;
}

}  // namespace

fs::path parts_file(const BakeSettings& settings, const Team* team) {
  if (!settings.part.is_all())
    return settings.output /
           fmt::format("part-{}-of-{}.luxel", settings.part.number, settings.part.of);
  return settings.output /
         (team ? fmt::format("checkpoint-{}.luxel", team->rank()) : "checkpoint.luxel");
}

std::vector<fs::path> part_files_in(const fs::path& folder) {
  return files_named(folder, "part-", ".luxel");
}

std::vector<fs::path> checkpoints_in(const fs::path& folder) {
  std::vector<fs::path> out = files_named(folder, "checkpoint", ".luxel");
  // checkpoint.luxel and checkpoint-3.luxel; not what somebody has put beside them.
  std::erase_if(out, [](const fs::path& file) {
    std::string rest = file.stem().string().substr(std::string_view("checkpoint").size());
    if (rest.empty()) return false;
    return rest.size() < 2 || rest[0] != '-' ||
           rest.find_first_not_of("0123456789", 1) != std::string::npos;
  });
  return out;
}

std::vector<fs::path> other_parts(const BakeSettings& settings, const fs::path& own) {
  std::vector<fs::path> out = settings.parts;
  if (!settings.part.is_all())
    out = part_files_in(settings.output);
  else if (settings.resume && settings.parts.empty())
    out = checkpoints_in(settings.output);
  std::erase(out, own);
  return out;
}

}  // namespace luxel::pipeline
