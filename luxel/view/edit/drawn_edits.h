// Edits on a graphics device: what is drawn follows in the next frame, its light later.
#pragma once

#include <vector>

#include "luxel/view/draw/device_scene.h"
#include "luxel/view/edit/tools.h"
#include "luxel/view/lit_scene.h"

namespace luxel::view {

/// For each material that is drawn, the one of the scene as it was read. `drawn` has an instance
/// for each of `as_read`; its materials are versions of those by `of_layout`, LitScene's
/// material_of_scene, or the same where that is empty.
std::vector<uint32_t> materials_as_read(const scene::Scene& as_read, const scene::Scene& drawn,
                                        std::span<const uint32_t> of_layout);

/// Puts instances and materials where edits have them. `of_material`: materials_as_read(). Nothing
/// may still draw the scene.
void put_edits(const SceneNow& now, std::span<const uint32_t> of_material, DeviceScene& scene);

/// The line around what is selected; none where that is nothing, or a lamp.
std::optional<Outline> outline_of(const EditSelection& selected,
                                  std::span<const uint32_t> of_material);

}  // namespace luxel::view
