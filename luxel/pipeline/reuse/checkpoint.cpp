#include "luxel/pipeline/reuse/checkpoint.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>
#include <vector>

#include "luxel/base/shown_text.h"
#include "luxel/pipeline/reuse/bake_parts.h"
#include "luxel/pipeline/settings/version.h"
#include "luxel/scene/digest.h"

namespace luxel::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The version of the records' content; goes up when what a part holds, or how it is computed,
/// changes.
constexpr int kCheckpointFormat = 5;

json digests_json(std::span<const scene::ItemDigest> items) {
  json out = json::array();
  for (const scene::ItemDigest& item : items)
    out.push_back({item.kind, item.name, fmt::format("{:016x}", item.digest)});
  return out;
}

std::vector<scene::ItemDigest> items_of(const json& list) {
  std::vector<scene::ItemDigest> out;
  for (const json& item : list)
    out.push_back({item[0].get<std::string>(), item[1].get<std::string>(),
                   std::stoull(item[2].get<std::string>(), nullptr, 16)});
  return out;
}

std::string text_of(const json& object, const std::string& key) {
  return object.contains(key) ? json_text(object[key]) : "nothing";
}

/// "samples 256 there, 512 here": the first by name.
std::string setting_difference(const json& there, const json& here, const std::string& prefix) {
  json keys = there;
  keys.update(here);
  for (const auto& [key, ignored] : keys.items()) {
    const bool both = there.contains(key) && here.contains(key);
    if (both && there[key] == here[key]) continue;
    if (both && there[key].is_object() && here[key].is_object())
      return setting_difference(there[key], here[key], prefix + key + ".");
    return fmt::format("{}{} {} there, {} here", prefix, key, text_of(there, key),
                       text_of(here, key));
  }
  return {};
}

std::string version_of(const json& header) {
  return fmt::format("luxel {} (checkpoints of format {})", header["luxel"].get<std::string>(),
                     header["format"].get<int>());
}

}  // namespace

json bake_identity(const json& settings) {
  return {{"luxel", kVersion}, {"format", kCheckpointFormat}, {"settings", settings}};
}

json checkpoint_header(const json& settings, const scene::Scene& scene) {
  json header = bake_identity(settings);
  header["scene"] = digests_json(scene::digests_of(scene));
  return header;
}

std::string difference(const json& there, const json& here) {
  try {
    if (there.at("luxel") != here.at("luxel") || there.at("format") != here.at("format"))
      return fmt::format("made by {}, this is {}", version_of(there), version_of(here));
    const std::string setting = setting_difference(there.at("settings"), here.at("settings"), "");
    if (!setting.empty() || (!there.contains("scene") && !here.contains("scene"))) return setting;
    return scene::difference(items_of(there.at("scene")), items_of(here.at("scene")));
  } catch (const std::exception&) {  // whole by its digest, but not written by a bake
    return "its header is not luxel's";
  }
}

namespace {

/// Differences between a file's header and the bake's; empty: none.
std::string difference_of(const RecordFile& file, const std::string& header) {
  return difference(json::parse(file.header(), nullptr, false), json::parse(header));
}

}  // namespace

Checkpoint::Checkpoint(const BakeSettings& settings, const json& identity, const json& all_settings,
                       const Team* team)
    : settings_(settings),
      file_(parts_file(settings, team)),
      identity_(std::make_unique<json>(identity)),
      all_settings_(std::make_unique<json>(all_settings)),
      start_(std::chrono::steady_clock::now()) {}

Checkpoint::~Checkpoint() = default;

/// The bake's own file as it was left; nothing where the bake begins anew.
Result<std::optional<RecordFile>> Checkpoint::own_file(const std::string& header,
                                                       Progress& progress) {
  const fs::path& file = file_;
  const bool is_part = !settings_.part.is_all(), goes_on = settings_.resume || is_part;
  std::error_code ignored;
  const bool there = fs::exists(file, ignored);
  std::optional<RecordFile> found;
  if (there && goes_on) {
    LUXEL_TRY(found, RecordFile::open(file));
    if (const std::string different = difference_of(*found, header); !different.empty())
      return fail(ErrorCode::bad_setting,
                  "{} belongs to another bake: {}; {} to start from the beginning", file.string(),
                  different, is_part ? "remove it" : "leave --resume out");
    resumed_ = true;
  } else if (there) {
    note_ = fmt::format(
        "{} belongs to an unfinished bake; this bake starts from the beginning, --resume would "
        "continue that one",
        file.string());
  } else if (settings_.resume && !is_part && settings_.parts.empty() &&
             other_parts(settings_, file).empty()) {
    note_ = fmt::format("there is no {} to resume from; the bake starts from the beginning",
                        file.string());
  }
  if (!note_.empty()) progress.note(note_);
  return found;
}

/// The files of other_parts().
Result<std::vector<RecordFile>> Checkpoint::other_files(const std::string& header,
                                                        Progress& progress) const {
  const bool are_checkpoints = settings_.part.is_all() && settings_.parts.empty();
  std::vector<RecordFile> out;
  for (const fs::path& file : other_parts(settings_, file_)) {
    Result<RecordFile> other = RecordFile::open_to_read(file);
    if (!other && !are_checkpoints) return Failure{other.error()};
    const std::string different = other ? difference_of(*other, header) : other.error().message;
    if (!different.empty() && are_checkpoints) {
      progress.note(fmt::format("{} is ignored: {}", file.string(), different));
      continue;
    }
    if (!different.empty())
      return fail(ErrorCode::bad_setting,
                  "{} belongs to another bake: {}; move it away, or give another --output",
                  file.string(), different);
    out.push_back(std::move(*other));
  }
  return out;
}

Status Checkpoint::open(const scene::Scene& scene, Progress& progress) {
  if (settings_.keep) return {};
  json described = checkpoint_header(*identity_, scene);
  described["bake"] = *all_settings_;
  // Names of things may be no UTF-8, which JSON knows nothing else of.
  const std::string header = json_text(described);
  header_ = header;
  LUXEL_TRY(std::optional<RecordFile> found, own_file(header, progress));
  LUXEL_TRY(std::vector<RecordFile> others, other_files(header, progress));
  resumed_ = resumed_ || (settings_.resume && !others.empty());
  PartStoreParams params{file_, header, "--resume continues from " + file_.string(),
                         settings_.checkpoint_s, start_};
  if (!settings_.parts.empty()) params.way_on = "the same command continues";
  if (!settings_.part.is_all()) {
    params.way_on = "the same command continues from " + params.file.string();
    params.share = PartShare{uint32_t(settings_.part.number - 1), uint32_t(settings_.part.of)};
    params.interval_s = std::max(params.interval_s, 1.0);
    params.start -= std::chrono::seconds(size_t(params.interval_s) + 1);  // from now on
  }
  parts_.emplace(std::move(params), progress, std::move(found), std::move(others));
  // Those who collect the files of all parts look for the file of an empty part, too.
  return settings_.part.is_all() ? Status() : parts_->begin();
}

json Checkpoint::about() const {
  if (!parts_) return nullptr;
  json out = {{"resumed", resumed_},
              {"parts_found", parts_->parts_found()},
              {"parts_kept", parts_->parts_kept()}};
  if (!note_.empty()) out["note"] = note_;
  return out;
}

bool Checkpoint::has_file() const { return parts_ && !checkpoints_in(settings_.output).empty(); }

void Checkpoint::remove() {
  if (!parts_) return;
  parts_.reset();
  std::error_code ignored;
  fs::remove(file_, ignored), fs::remove(RecordFile::unfinished_name(file_), ignored);
  if (!settings_.part.is_all()) return;
  for (const fs::path& file : checkpoints_in(settings_.output)) {
    const auto other = RecordFile::open_to_read(file, RecordFile::Check::when_read);
    if (other && difference_of(*other, header_).empty()) fs::remove(file, ignored);
  }
}

}  // namespace luxel::pipeline
