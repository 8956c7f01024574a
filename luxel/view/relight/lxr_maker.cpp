#include "luxel/view/relight/lxr_maker.h"

#include <nlohmann/json.hpp>

#include "luxel/base/output_folder.h"
#include "luxel/base/parallel.h"

namespace luxel::view {
namespace {

Lamps without_deleted(const SceneNow& now) {
  Lamps out;
  for (const EditedLamp& lamp : now.lamps)
    if (!lamp.is_deleted) out.lamps.push_back(lamp);
  return out;
}

/// Lamps that are off keep their number, and shine not.
scene::Scene scene_to_make(const LxrToMake& to_make) {
  scene::Scene out = edited(to_make.read->scene, to_make.now);
  out.lights.clear();
  for (const Lamp& lamp : without_deleted(to_make.now).lamps) {
    out.lights.push_back(lamp.light);
    if (!lamp.is_on) out.lights.back().intensity = {};
  }
  return out;
}

Result<pipeline::Relightable> made_anew(const scene::Scene& scene,
                                        const pipeline::RelightSettings& settings,
                                        Progress& progress) {
  OutputFolder folder(settings.output.parent_path());
  LUXEL_TRY_STATUS(folder.make());
  LUXEL_TRY_STATUS(pipeline::check(settings));
  const ThreadLimit threads(settings.threads);
  LUXEL_TRY(pipeline::Relightable made, pipeline::make_relightable(scene, settings, progress));
  // One that was stopped meanwhile may have taken the folder along.
  LUXEL_TRY_STATUS(folder.make());
  LUXEL_TRY_STATUS(
      pipeline::write_relightable(settings, made, progress).map([](const nlohmann::json&) {}));
  folder.keep();
  if (const Status kept = keep_lxr(scene, settings, made.warnings); !kept)
    made.warnings.push_back("the file cannot be used again: " + kept.error().message);
  return made;
}

/// A file has no lamps that are off: they are dark there.
void switch_off(const SceneNow& now, OpenedLxr& opened) {
  const std::vector<Lamp> lamps = without_deleted(now).lamps;
  for (size_t i = 0; i < lamps.size(); ++i)
    if (!lamps[i].is_on) opened.lamps.lamps[i] = lamps[i];
}

}  // namespace

Result<MadeLxr> make_lxr(const LxrToMake& to_make, Progress& progress) {
  const pipeline::RelightSettings& settings = to_make.settings;
  progress.begin("look for a prepared file", 0);
  const scene::Scene scene = scene_to_make(to_make);
  std::optional<pipeline::Relightable> data = kept_lxr(scene, settings);
  const bool was_there = data.has_value();
  LUXEL_TRY_STATUS(stopped(progress));
  if (!was_there) {
    LUXEL_TRY(data, made_anew(scene, settings, progress));
  }
  progress.begin("open it", 0);
  LUXEL_TRY(OpenedLxr opened,
            opened_lxr(std::move(data->data), settings.output, to_make.read.get()));
  switch_off(to_make.now, opened);
  return MadeLxr{std::move(opened), std::move(data->warnings), was_there};
}

std::unique_ptr<LxrMaker> begin_lxr_maker() {
  return std::make_unique<LxrMaker>(
      [](const LxrToMake& to_make, const LxrMaker::Hand& hand, Progress& progress) -> Status {
        LUXEL_TRY(MadeLxr made, make_lxr(to_make, progress));
        hand(std::move(made));
        return {};
      });
}

}  // namespace luxel::view
