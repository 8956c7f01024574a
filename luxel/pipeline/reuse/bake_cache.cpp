#include "luxel/pipeline/reuse/bake_cache.h"

#include <atomic>
#include <nlohmann/json.hpp>
#include <utility>

#include "luxel/base/check.h"
#include "luxel/base/digest.h"
#include "luxel/base/parallel.h"
#include "luxel/base/shown_text.h"
#include "luxel/pipeline/reuse/checkpoint.h"

namespace luxel::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The version of the cache's files; goes up when what they hold changes.
constexpr int kFormat = 6;
RecordKey key_of(size_t part) { return {0, part}; }

fs::path light_file(const fs::path& folder) { return folder / "light.luxel"; }
fs::path rays_file(const fs::path& folder) { return folder / "rays.luxel"; }
fs::path unfinished(fs::path file) { return file += ".new"; }

json identity_of(const BakeSettings& settings, const json& changing) {
  json identity = bake_identity(changing);
  identity["cache"] = kFormat;
  const bool groups = settings.layers == light::LayerMode::groups;
  identity["settings"]["lights told apart"] = groups ? "by groups" : "one by one";
  return identity;
}

/// Rays and light that were kept together have the same one.
uint64_t digest_of_state(const scene::SceneState& state) {
  KeptBake kept;
  kept.scene = state;
  return digest_of(bytes_of(kept, 0));
}

/// Nothing where it is damaged.
std::optional<KeptBake> read_kept(const RecordFile& file) {
  KeptBake kept;
  std::atomic<bool> good{true};
  parallel_for(kKeptParts, 1, [&](size_t part, size_t) {
    const auto bytes = file.read_whole(key_of(part));
    if (!bytes || !read_part(*bytes, part, kept)) good = false;
  });
  if (!good || !is_whole(kept)) return std::nullopt;
  return kept;
}

Status write_kept(const KeptBake& kept, RecordFile& file) {
  for (size_t part = 0; part < kKeptParts; ++part)
    LUXEL_TRY_STATUS(file.append(key_of(part), bytes_of(kept, part)));
  return {};
}

std::string header_of(const json& identity, const scene::SceneState& state) {
  json header = identity;
  header["digest"] = fmt::format("{:016x}", digest_of_state(state));
  return json_text(header);
}

}  // namespace

BakeCache::BakeCache(const BakeSettings& settings, const json& identity)
    : settings_(settings),
      identity_(std::make_unique<json>(identity_of(settings, identity))),
      folder_(settings.output / "cache") {}

BakeCache::~BakeCache() { remove_unfinished(); }

void BakeCache::remove_unfinished() {
  if (!rays_) return;
  rays_.reset(), kept_.reset();
  std::error_code ignored;
  for (const fs::path& file : {light_file(folder_), rays_file(folder_)}) {
    fs::remove(unfinished(file), ignored);
    fs::remove(RecordFile::unfinished_name(unfinished(file)), ignored);
  }
  fs::remove(folder_, ignored);  // if it is empty
}

void BakeCache::open(const scene::Scene& scene, Progress& progress) {
  if (!settings_.keep) return;
  state_ = scene::state_of(scene);
  if (find(scene)) {
    changed_ = scene::in_words(state_, change_);
    progress.note(changed_.empty() ? "nothing has changed since the kept bake"
                                   : "changed since the kept bake: " + changed_);
    return;
  }
  if (!note_.empty()) progress.note(note_);
  begin(progress);
}

/// True where the cache holds a bake to build on. Else note_ says why not, unless there is no
/// cache.
bool BakeCache::find(const scene::Scene& scene) {
  const fs::path file = light_file(folder_);
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return false;
  const auto no = [&](std::string_view why) {
    note_ =
        fmt::format("{}: {}; this bake starts from scratch and replaces it", folder_.string(), why);
    return false;
  };
  const Result<RecordFile> found = RecordFile::open(file, RecordFile::Check::when_read);
  if (!found) return no(found.error().message);
  json header = json::parse(found->header(), nullptr, false);
  if (!header.is_object() || !header.contains("cache") || header["cache"] != kFormat)
    return no("it was kept by another version of luxel");
  const std::string different = difference(header, *identity_);
  if (!different.empty()) return no("it belongs to another bake: " + different);
  found_ = read_kept(*found);
  if (!found_) return no("light.luxel is damaged");
  change_ = scene::change_between(found_->scene, state_);
  // Surfaces have light of their own on both sides depending on whether light gets behind them.
  for (const uint32_t m : change_.reshaped)
    if (scene.materials[m].double_sided)
      change_.beyond = fmt::format("double-sided material '{}' transmits light differently",
                                   scene.materials[m].name);
  if (change_.beyond.empty() && found_->layout.mesh_of_instance.size() == scene.instances.size()) {
    seconds_before_ = found_->seconds;
    return built_on_ = true;
  }
  found_.reset();
  return no(change_.beyond.empty() ? "it belongs to another scene" : change_.beyond);
}

const RecordFile* BakeCache::found_rays(Progress& progress) {
  LUXEL_CHECK(found_);
  if (found_rays_) return &*found_rays_;
  Result<RecordFile> rays = RecordFile::open(rays_file(folder_), RecordFile::Check::when_read);
  if (!rays)
    note_ = rays.error().message;
  else if (rays->header() != header_of(*identity_, found_->scene))
    note_ = rays_file(folder_).string() + " does not belong to the kept bake";
  else
    return &found_rays_.emplace(std::move(*rays));
  note_ += "; all rays are traced; remove the folder to keep a new bake";
  progress.note(note_);
  return nullptr;
}

void BakeCache::begin(Progress& progress) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error)
    return give_up(fmt::format("cannot make {}: {}", folder_.string(), error.message()), progress);
  // It begins long ago: parts are wanted at once, and not waited for.
  constexpr double kForever_s = 1e6;
  rays_.emplace(
      PartStoreParams{unfinished(rays_file(folder_)), header_of(*identity_, state_), "", kForever_s,
                      std::chrono::steady_clock::now() - std::chrono::seconds(int(kForever_s) + 1)},
      progress);
}

bool BakeCache::make_room(Progress& progress) {
  if (!rays_) return false;
  remove_unfinished();
  if (failure_.empty()) give_up("the disk is full", progress);
  return true;
}

std::string BakeCache::failure() const {
  return failure_.empty() && rays_ ? rays_->failure() : failure_;
}

void BakeCache::give_up(std::string reason, Progress& progress) {
  failure_ = std::move(reason) + "; the bake is not kept";
  progress.note("warning: " + failure_);
}

void BakeCache::solved() { seconds_ = seconds_since(start_); }

void BakeCache::finish(Progress& progress) {
  if (!rays_ || !kept_) return;
  if (rays_->has_failed()) return give_up(rays_->failure(), progress);
  kept_->scene = state_, kept_->seconds = seconds_, kept_->layout = std::move(layout_);
  const fs::path file = light_file(folder_);
  Result<RecordFile> light = RecordFile::create(unfinished(file), header_of(*identity_, state_));
  if (!light) return give_up(light.error().message, progress);
  const Status written = write_kept(*kept_, *light);
  if (!written) return give_up(written.error().message, progress);
  // Without light the rays are not looked at: at no moment do the two not belong together.
  std::error_code error;
  fs::remove(file, error);
  fs::rename(unfinished(rays_file(folder_)), rays_file(folder_), error);
  if (!error) fs::rename(unfinished(file), file, error);
  if (error) give_up(fmt::format("{}: {}", folder_.string(), error.message()), progress);
}

json BakeCache::about(const TexelLight& light) const {
  if (!settings_.keep) return nullptr;
  json out = {{"built_on", built_on_}, {"kept", rays_.has_value() && failure().empty()}};
  if (!note_.empty()) out["note"] = note_;
  if (!failure().empty()) out["failure"] = failure();
  if (!built_on_) return out;
  out["changed"] = changed_;
  out["rays_traced"] = light.rays, out["rays_kept"] = light.rays_kept;
  out["seconds_from_scratch"] = seconds_before_, out["seconds"] = seconds_;
  return out;
}

}  // namespace luxel::pipeline
