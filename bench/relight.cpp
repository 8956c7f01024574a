// luxel bench relight: what is measured, on which scenes.
#include "bench/relight.h"

#include "luxel/import/import.h"
#include "luxel/scene/procedural.h"

namespace luxel::bench {
namespace {

constexpr size_t kPaperPatches = 4096;

/// Rooms that people made: smooth things close together; furniture, beams and windows.
struct RealScene {
  const char *name, *file;
  size_t patches;
};
constexpr RealScene kRealScenes[]{{"suzanne_room", "room.glb", 8192},
                                  {"suzanne_room", "room.glb", 32768},
                                  {"living_room", "living_room.glb", 8192}};

Status judge_all(const std::filesystem::path& shared, RelightRuns& runs, Progress& progress) {
  LUXEL_TRY(JudgedRelight box, judge_relight("Cornell box", scene::cornell_box(), {}, progress));
  runs.judged.push_back(std::move(box));
  for (const RealScene& real : kRealScenes) {
    const std::filesystem::path file = shared / "scenes" / real.name / real.file;
    if (!std::filesystem::exists(file)) {
      runs.missing.emplace_back(real.name);
      continue;
    }
    LUXEL_TRY(import::Imported room, import::import_scene(file));
    JudgeSettings settings;
    settings.patches = real.patches;
    LUXEL_TRY(JudgedRelight judged,
              judge_relight(real.name, std::move(room.scene), settings, progress));
    runs.judged.push_back(std::move(judged));
  }
  return {};
}

}  // namespace

Result<RelightPage> measure_relight(const std::filesystem::path& shared, Progress& progress) {
  RelightRuns runs;
  LUXEL_TRY(runs.paper, measure_paper(kPaperPatches, progress));
  LUXEL_TRY(runs.codecs, run_codecs(progress));
  LUXEL_TRY(runs.sizes, run_sizes(progress));
  LUXEL_TRY_STATUS(judge_all(shared, runs, progress));
  return page_of(std::move(runs));
}

}  // namespace luxel::bench
