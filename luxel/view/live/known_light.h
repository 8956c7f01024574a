// Light of a bake that follows edits of its scene by what drafts say of them.
#pragma once

#include <span>
#include <vector>

#include "luxel/light/texel_scene.h"
#include "luxel/view/live/draft.h"

namespace luxel::view {

/// What is known of the texels of a bake.
struct KnownLight {
  atlas::Atlas atlas;
  atlas::TexelMap map;
  /// A place of the surface of each texel and the normal of its front, both in the coordinates of
  /// its instance's mesh.
  std::vector<Place> places;
  std::vector<Rgb> irradiance;  ///< E [W/m^2]
  std::vector<Rgb> drafted;     ///< what a draft of the same scene has there
};

/// `draft` is one of the scene that `in` was laid out from; E is to be filled in.
KnownLight known_light(const light::TexelScene& in, const Draft& draft);

/// E of each texel after an edit: what is known, and what the draft of the edited scene has more or
/// less there than the one before; where that is much, the draft's. So light stays sharp where
/// nothing has changed. The instances stand where `world_from_object` says.
std::vector<Rgb> light_after_edit(const KnownLight& known, const Draft& edited,
                                  std::span<const Mat34> world_from_object);

}  // namespace luxel::view
