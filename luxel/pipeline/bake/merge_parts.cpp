#include "luxel/pipeline/bake/merge_parts.h"

#include <nlohmann/json.hpp>

#include "luxel/base/check.h"
#include "luxel/base/record_file.h"
#include "luxel/pipeline/reuse/bake_parts.h"
#include "luxel/pipeline/solver/bake_options.h"

namespace luxel::pipeline {

namespace fs = std::filesystem;

namespace {

Failure no_parts_in(const fs::path& place) {
  return fail(ErrorCode::bad_input, "{} has no parts of a bake; luxel bake --part makes them",
              place.string());
}

Result<BakeSettings> settings_of_part(const fs::path& file) {
  LUXEL_TRY(const RecordFile found, RecordFile::open_to_read(file, RecordFile::Check::when_read));
  const nlohmann::json header = nlohmann::json::parse(found.header(), nullptr, false);
  if (!header.is_object() || !header.contains("bake")) return no_parts_in(file);
  BakeSettings out;
  if (const Status read = read_json(header["bake"], out); !read)
    return fail(read.error().code, "{}: {}", file.string(), read.error().message);
  return out;
}

}  // namespace

Result<BakeSettings> settings_of_parts(std::span<const fs::path> given) {
  std::vector<fs::path> files;
  for (const fs::path& one : given) {
    std::error_code ignored;
    if (!fs::is_directory(one, ignored)) {
      files.push_back(one);
      continue;
    }
    const std::vector<fs::path> inside = part_files_in(one);
    if (inside.empty()) return no_parts_in(one);
    files.insert(files.end(), inside.begin(), inside.end());
  }
  LUXEL_CHECK(!files.empty());
  LUXEL_TRY(BakeSettings out, settings_of_part(files.front()));
  out.parts = std::move(files);
  const BakeSettings usual;
  out.threads = usual.threads, out.max_memory_bytes = usual.max_memory_bytes;
  out.keep = usual.keep, out.resume = true;
  return out;
}

}  // namespace luxel::pipeline
