#include "luxel/pipeline/bake/bake.h"

#include <nlohmann/json.hpp>

#include "luxel/base/check.h"
#include "luxel/base/file.h"
#include "luxel/base/file_lock.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/parallel.h"
#include "luxel/base/share_out.h"
#include "luxel/base/shown_text.h"
#include "luxel/pipeline/bake/bake_files.h"
#include "luxel/pipeline/bake/bake_report.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/bake/bake_team.h"
#include "luxel/pipeline/reuse/bake_cache.h"
#include "luxel/pipeline/reuse/bake_parts.h"
#include "luxel/pipeline/reuse/checkpoint.h"
#include "luxel/pipeline/solver/bake_options.h"

namespace luxel::pipeline {
namespace {

/// A full disk has room when the checkpoint, and what is kept for later bakes, are gone.
Status write_results(std::span<const OutputFile> files, Checkpoint& checkpoint, BakeCache& cache,
                     Progress& progress) {
  const Status written = write_files_atomically(files);
  if (written || written.error().code != ErrorCode::out_of_disk) return written;
  const bool has_file = checkpoint.has_file();
  if (!cache.make_room(progress) && !has_file) return written;
  checkpoint.remove();
  return write_files_atomically(files);
}

/// A bake's files, bake.json the last of them.
struct FinishedFiles {
  std::vector<OutputFile> files;
  nlohmann::json report;
};

/// `about_stores`: what bake.json says of checkpoint and cache. `baked`: the stages of the bake.
Result<FinishedFiles> finished_files(const BakeSettings& settings, const Bake& bake,
                                     const nlohmann::json& about_stores, const Progress& baked,
                                     Progress& progress) {
  progress.begin(kWriteStage, 0);
  FinishedFiles out;
  nlohmann::json about_files = nlohmann::json::object();
  LUXEL_TRY(out.files, files_of(settings, bake, about_files, progress));
  LUXEL_TRY_STATUS(stopped(progress));
  progress.finish();
  out.report = bake_report(settings, bake, baked);
  out.report.update(about_stores);
  out.report.update(about_files);
  nlohmann::json& names = out.report["files"] = nlohmann::json::array();
  for (const OutputFile& file : out.files) names.push_back(file.path.filename().string());
  names.push_back("bake.json");
  out.files.push_back(text_file(settings.output / "bake.json", json_text(out.report, 2) + "\n"));
  return out;
}

/// `luxel bake --part`.
Result<nlohmann::json> bake_part(const BakeSettings& settings, Progress& progress,
                                 const BakeDevice* device) {
  if (device)
    return fail(ErrorCode::bad_setting,
                "--part {}/{} runs on the processor only; leave --device out", settings.part.number,
                settings.part.of);
  const std::filesystem::path file = parts_file(settings);
  OutputFolder folder(settings.output);
  LUXEL_TRY_STATUS(folder.make());
  LUXEL_TRY(const FileLock lock, FileLock::take(file.string() + ".lock", file.string()));
  Checkpoint checkpoint(settings, settings_of_checkpoint(settings), to_json(settings));
  const Result<Bake> ended = bake_scene(settings, progress, {.checkpoint = &checkpoint});
  const PartStore* parts = checkpoint.parts();
  if (parts != nullptr && parts->has_failed()) return Failure{*parts->error()};
  // The last stages are left to `luxel merge` in any case.
  LUXEL_CHECK(!ended);
  if (ended.error().code != ErrorCode::parts_missing) return Failure{ended.error()};
  folder.keep();
  return nlohmann::json{{"part",
                         {{"number", settings.part.number},
                          {"of", settings.part.of},
                          {"file", file.string()},
                          {"parts_kept", parts->parts_kept()},
                          {"parts_found", parts->parts_found()},
                          {"parts_left", parts->parts_left()}}}};
}

nlohmann::json identity_of(const BakeSettings& settings) {
  return bake_identity(settings_of_checkpoint(settings));
}

/// Makes and writes a bake, as its only process or as a team's first member.
Result<nlohmann::json> bake_whole(const BakeSettings& settings, Progress& progress,
                                  const BakeDevice* device, Team* team) {
  OutputFolder folder(settings.output);
  LUXEL_TRY_STATUS(folder.hold(progress));
  // The other members begin when they have this: the folder is there.
  LUXEL_TRY_STATUS(check_same_settings(team, identity_of(settings), progress));
  Checkpoint checkpoint(settings, settings_of_checkpoint(settings), to_json(settings), team);
  BakeCache cache(settings, settings_of_kept_bake(settings));
  LUXEL_TRY(Bake result, bake_scene(settings, progress, {&checkpoint, &cache, device, team}));
  if (checkpoint.parts() != nullptr && checkpoint.parts()->has_failed())
    result.warnings.push_back(checkpoint.parts()->failure());
  if (!cache.failure().empty()) result.warnings.push_back(cache.failure());
  LUXEL_TRY(FinishedFiles finished, finished_files(settings, result,
                                                   {{"checkpoint", checkpoint.about()},
                                                    {"cache", cache.about(result.light)},
                                                    {"team", about_team(team)}},
                                                   progress, progress));
  LUXEL_TRY_STATUS(folder.make());
  LUXEL_TRY_STATUS(write_results(finished.files, checkpoint, cache, progress));
  folder.keep();
  checkpoint.remove();
  cache.finish(progress);
  return std::move(finished.report);
}

/// Helps to bake, as any member of a team but the first.
Result<nlohmann::json> help_to_bake(const BakeSettings& settings, Progress& progress, Team& team) {
  LUXEL_TRY_STATUS(check_same_settings(&team, identity_of(settings), progress));
  Checkpoint checkpoint(settings, settings_of_checkpoint(settings), to_json(settings), &team);
  const Result<Bake> ended =
      bake_scene(settings, progress, {.checkpoint = &checkpoint, .team = &team});
  LUXEL_CHECK(!ended);
  if (ended.error().code != ErrorCode::parts_missing) return Failure{ended.error()};
  return nlohmann::json::object();
}

}  // namespace

Result<nlohmann::json> bake(const BakeSettings& settings, Progress& progress,
                            const BakeDevice* device, Team* team) {
  LUXEL_TRY_STATUS(check(settings));
  LUXEL_TRY_STATUS(check_team(team, settings, device != nullptr));
  const ThreadLimit threads(settings.threads);
  if (!settings.part.is_all()) return bake_part(settings, progress, device);
  return or_give_up(team, !team || team->rank() == 0 ? bake_whole(settings, progress, device, team)
                                                     : help_to_bake(settings, progress, *team));
}

Result<nlohmann::json> save_bake(const BakeSettings& settings, const Bake& bake,
                                 const Progress& baked, Progress& progress) {
  const ThreadLimit threads(settings.threads);
  OutputFolder folder(settings.output);
  LUXEL_TRY_STATUS(folder.hold(progress));
  LUXEL_TRY(FinishedFiles finished,
            finished_files(settings, bake,
                           {{"checkpoint", nullptr}, {"cache", nullptr}, {"team", nullptr}}, baked,
                           progress));
  LUXEL_TRY_STATUS(folder.make());
  LUXEL_TRY_STATUS(write_files_atomically(finished.files));
  folder.keep();
  return std::move(finished.report);
}

}  // namespace luxel::pipeline
