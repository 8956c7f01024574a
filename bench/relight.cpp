// luxel bench relight: what is measured, on which scenes.
#include "bench/relight.h"

#include <algorithm>

#include "luxel/import/import.h"
#include "luxel/scene/procedural.h"

namespace luxel::bench {
namespace {

constexpr size_t kPaperPatches = 4096;

/// A scene in which the relighter is compared with the path tracer. Two of them are rooms that
/// people made: smooth things close together; furniture, beams and windows.
struct JudgedScene {
  const char *name, *title;
  const char* file;  ///< in shared/scenes/NAME; none: scene::cornell_box()
  size_t patches;
};
constexpr JudgedScene kJudgedScenes[]{{"cornell_box", "Cornell box", nullptr, 8192},
                                      {"suzanne_room", "suzanne_room", "room.glb", 8192},
                                      {"suzanne_room", "suzanne_room", "room.glb", 32768},
                                      {"living_room", "living_room", "living_room.glb", 8192}};

Status judge_scene(const JudgedScene& judged, const std::filesystem::path& shared,
                   JudgedScenes& out, Progress& progress) {
  scene::Scene scene = scene::cornell_box();
  if (judged.file) {
    const std::filesystem::path file = shared / "scenes" / judged.name / judged.file;
    if (!std::filesystem::exists(file)) {
      out.missing.emplace_back(judged.name);
      return {};
    }
    LUXEL_TRY(import::Imported imported, import::import_scene(file));
    scene = std::move(imported.scene);
  }
  JudgeSettings settings;
  settings.patches = judged.patches;
  LUXEL_TRY(JudgedRelight run, judge_relight(judged.title, std::move(scene), settings, progress));
  out.runs.push_back(std::move(run));
  return {};
}

/// The scene of a name; all where it is empty.
Result<JudgedScenes> judge_scenes(const std::filesystem::path& shared, const std::string& name,
                                  Progress& progress) {
  JudgedScenes out;
  for (const JudgedScene& judged : kJudgedScenes)
    if (name.empty() || name == judged.name)
      LUXEL_TRY_STATUS(judge_scene(judged, shared, out, progress));
  if (out.runs.empty() && out.missing.empty())
    return fail(ErrorCode::bad_setting,
                "--scene {} is not among cornell_box, suzanne_room, living_room", name);
  return out;
}

}  // namespace

Result<RelightPage> measure_relight(const std::filesystem::path& shared, Progress& progress) {
  RelightRuns runs;
  LUXEL_TRY(runs.paper, measure_paper(kPaperPatches, progress));
  LUXEL_TRY(runs.codecs, run_codecs(progress));
  LUXEL_TRY(runs.sizes, run_sizes(progress));
  LUXEL_TRY(runs.judged, judge_scenes(shared, {}, progress));
  return page_of(std::move(runs));
}

Result<RelightPage> measure_relight_in(const std::filesystem::path& shared,
                                       const std::string& scene, Progress& progress) {
  LUXEL_TRY(const JudgedScenes judged, judge_scenes(shared, scene, progress));
  RelightPage page;
  append(judged, page);
  return page;
}

}  // namespace luxel::bench
