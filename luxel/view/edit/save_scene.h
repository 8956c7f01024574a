// An edited scene as a file.
#pragma once

#include <filesystem>

#include "luxel/pipeline/settings/settings.h"
#include "luxel/view/edit/edits.h"

namespace luxel::view {

struct SceneToSave {
  std::shared_ptr<const ReadScene> read;  ///< the scene as it was read
  SceneNow now;
  pipeline::BakeSettings settings;  ///< says which file it was read from, how, and where to save
};

/// Writes it into settings.output, as NAME-edited.glb or .gltf, or with the next number that is
/// free. Of a glTF file only what was edited is otherwise (export_::edited_gltf); other files
/// become .glb. Lamps that are off have the intensity 0, those that are deleted are gone. Light
/// that options have added is in it only where it was edited; a sky and its sun are not. Returns
/// the file. Takes as long as reading the scene. Errors: those of files; the file has changed since
/// it was read.
Result<std::filesystem::path> save_scene(const SceneToSave& to_save);

/// The end of a sentence that says what a saved file lacks of an edited sky; empty: nothing.
std::string what_sky_lacks(const SceneToSave& to_save);

}  // namespace luxel::view
