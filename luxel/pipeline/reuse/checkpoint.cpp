#include "luxel/pipeline/reuse/checkpoint.h"

#include <nlohmann/json.hpp>
#include <span>
#include <utility>
#include <vector>

#include "luxel/pipeline/settings/version.h"
#include "luxel/scene/digest.h"

namespace luxel::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The version of the records' content; goes up when what a part holds, or how it is computed,
/// changes.
constexpr int kCheckpointFormat = 3;

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
  return object.contains(key) ? object[key].dump() : "nothing";
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

fs::path checkpoint_file(const BakeSettings& settings) {
  return settings.output / "checkpoint.luxel";
}

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
    if (!setting.empty() || !there.contains("scene")) return setting;
    return scene::difference(items_of(there.at("scene")), items_of(here.at("scene")));
  } catch (const std::exception&) {  // whole by its digest, but not written by a bake
    return "its header is none of luxel's";
  }
}

Checkpoint::Checkpoint(const BakeSettings& settings, const json& identity)
    : settings_(settings),
      identity_(std::make_unique<json>(identity)),
      start_(std::chrono::steady_clock::now()) {}

Checkpoint::~Checkpoint() = default;

Status Checkpoint::open(const scene::Scene& scene, Progress& progress) {
  if (settings_.keep) return {};
  const fs::path file = checkpoint_file(settings_);
  // Names of things may be no UTF-8, which JSON knows nothing else of.
  const std::string header =
      checkpoint_header(*identity_, scene).dump(-1, ' ', false, json::error_handler_t::replace);
  std::optional<RecordFile> found;
  std::error_code ignored;
  const bool there = fs::exists(file, ignored);
  if (there && settings_.resume) {
    LUXEL_TRY(found, RecordFile::open(file));
    const std::string different =
        difference(json::parse(found->header(), nullptr, false), json::parse(header));
    if (!different.empty())
      return fail(ErrorCode::bad_setting,
                  "{} is of another bake: {}; leave --resume out to start from the beginning",
                  file.string(), different);
    resumed_ = true;
  } else if (there) {
    note_ = fmt::format(
        "{} is of a bake that did not end; this one starts from the beginning, --resume would go "
        "on with it",
        file.string());
  } else if (settings_.resume) {
    note_ = fmt::format("there is no {} to resume from; the bake starts from the beginning",
                        file.string());
  }
  if (!note_.empty()) progress.note(note_);
  parts_.emplace(PartStoreParams{file, header, "--resume goes on from " + file.string(),
                                 settings_.checkpoint_s, start_},
                 progress, std::move(found));
  return {};
}

json Checkpoint::about() const {
  if (!parts_) return nullptr;
  json out = {{"resumed", resumed_},
              {"parts_found", parts_->parts_found()},
              {"parts_kept", parts_->parts_kept()}};
  if (!note_.empty()) out["note"] = note_;
  return out;
}

bool Checkpoint::has_file() const {
  std::error_code ignored;
  return parts_ && fs::exists(checkpoint_file(settings_), ignored);
}

void Checkpoint::remove() {
  if (!parts_) return;
  parts_.reset();
  std::error_code ignored;
  const fs::path file = checkpoint_file(settings_);
  fs::remove(file, ignored), fs::remove(RecordFile::unfinished_name(file), ignored);
}

}  // namespace luxel::pipeline
