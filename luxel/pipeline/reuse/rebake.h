// The light of a kept bake after a change of the scene. docs/method/rebake.md
#pragma once

#include <optional>
#include <vector>

#include "luxel/pipeline/reuse/kept_bake.h"
#include "luxel/solve/gather/reuse/earlier.h"

namespace luxel::pipeline {

/// The lights of a kept bake as they shine now.
struct LightUpdate {
  /// Per layer, what its light is multiplied by, per channel; nothing: its lights shine otherwise
  /// than before.
  std::vector<std::optional<Rgb>> scale;
  std::vector<uint32_t> changed_punctual;  ///< punctual lights that do, and those of such layers
  bool surfaces_changed = false;           ///< surfaces, or the surroundings, do
};
/// `change` is that from kept.scene to `scene`, which may have more materials by now.
LightUpdate light_update(const KeptBake& kept, const scene::SceneChange& change,
                         const scene::Scene& scene);

/// True: the light now is a sum of the layers' light, each layer times a factor. E is linear in its
/// sources, channel by channel, as long as nothing moves and every surface reflects as before.
bool is_sum_of_layers(const LightUpdate& update, const scene::SceneChange& change);
/// That sum. How sure it is, relative to its value, is taken to be as before.
TexelLight sum_of_layers(KeptBake& kept, const LightUpdate& update);

/// The kept data that gather needs where no such sum gives the light. `in` has the elements of the
/// map now; `layers`: those of this bake, or null. Uses `kept` up. Nothing: its rays are damaged.
std::optional<gather::Earlier> earlier_of(KeptBake& kept, const RecordFile& rays,
                                          const LightUpdate& update,
                                          const scene::SceneChange& change,
                                          const light::TexelScene& in,
                                          const light::LightLayers* layers);

}  // namespace luxel::pipeline
