#include "luxel/pipeline/bake/bake.h"

#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/bake/bake_files.h"
#include "luxel/pipeline/bake/bake_report.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/reuse/bake_cache.h"
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

}  // namespace

Result<nlohmann::json> bake(const BakeSettings& settings, Progress& progress) {
  LUXEL_TRY_STATUS(check(settings));
  const ThreadLimit threads(settings.threads);
  OutputFolder folder(settings.output);
  LUXEL_TRY_STATUS(folder.hold(progress));
  Checkpoint checkpoint(settings, settings_of_checkpoint(settings));
  BakeCache cache(settings, settings_of_kept_bake(settings));
  LUXEL_TRY(Bake result, bake_scene(settings, progress, {&checkpoint, &cache}));
  if (checkpoint.parts() != nullptr && checkpoint.parts()->has_failed())
    result.warnings.push_back(checkpoint.parts()->failure());
  if (!cache.failure().empty()) result.warnings.push_back(cache.failure());
  progress.begin(kWriteStage, 0);
  nlohmann::json about_files = nlohmann::json::object();
  LUXEL_TRY(std::vector<OutputFile> files, files_of(settings, result, about_files, progress));
  LUXEL_TRY_STATUS(stopped(progress));
  progress.finish();
  nlohmann::json json = bake_report(settings, result, progress);
  json["checkpoint"] = checkpoint.about();
  json["cache"] = cache.about(result.light);
  json.update(about_files);
  nlohmann::json& names = json["files"] = nlohmann::json::array();
  for (const OutputFile& file : files) names.push_back(file.path.filename().string());
  names.push_back("bake.json");
  files.push_back(text_file(settings.output / "bake.json", json.dump(2) + "\n"));
  LUXEL_TRY_STATUS(folder.make());
  LUXEL_TRY_STATUS(write_results(files, checkpoint, cache, progress));
  folder.keep();
  checkpoint.remove();
  cache.finish(progress);
  return json;
}

}  // namespace luxel::pipeline
