// Coarse light, to be looked at until there is better: a bake of few texels and few rays.
#pragma once

#include <memory>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/light/texel_scene.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::view {

/// It stays where it is: the tracer looks at the scene.
struct Draft {
  scene::Scene scene;  ///< as it was laid out
  std::optional<trace::RayTracer> tracer;
  atlas::Atlas atlas;
  atlas::TexelMap map;
  std::vector<Rgb> irradiance;  ///< E per texel of the map [W/m^2], after all bounces
  std::vector<Rgb> direct;      ///< the part of it that comes straight from lights
  /// E but for what comes straight from lamps; empty: that is not told apart.
  std::vector<Rgb> without_lamps;
  std::vector<std::vector<Rgb>> bounced;  ///< E after 0, 1, ..., kMostBounces reflections
};

/// Sample counts of a draft.
struct DraftParams {
  int samples = 32, direct_samples = 8, supersample = 4;  ///< as BakeSettings has them
};
inline constexpr DraftParams kFirstDraft{};
/// After an edit, when light is to follow within 0.2 s.
inline constexpr DraftParams kQuickDraft{16, 4, 1};

/// Bakes `scene`, which was read and has its outside light. Null where that would take long, since
/// there are many triangles, where another solver than gather is asked for, and where the bake
/// itself is no finer. Errors: those of a bake; cancelled.
Result<std::unique_ptr<Draft>> make_draft(const scene::Scene& scene,
                                          const pipeline::BakeSettings& settings,
                                          const DraftParams& params, const Progress& watched);

/// A place of a surface in the world [m], and the normal of its front.
struct Place {
  Vec3 position, normal;
};

/// E of a draft at places of its scene, which is laid out in another way: all of it, or the part
/// that is direct. Places at which the draft has no surface get the mean.
std::vector<Rgb> light_of_draft(const Draft& draft, std::span<const Rgb> of_texels,
                                std::span<const Place> places);
std::vector<Rgb> light_of_draft(const Draft& draft, std::span<const Rgb> of_texels,
                                const light::TexelScene& in);

}  // namespace luxel::view
