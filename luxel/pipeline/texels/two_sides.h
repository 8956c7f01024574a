// The double-sided surfaces that get light of their own on each side.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/pipeline/texels/wrong_sides.h"
#include "luxel/scene/scene.h"

namespace luxel::pipeline {

/// Per mesh, one flag per triangle: 1 where it is double-sided and its back sees the open. Empty
/// for meshes without any. Many exporters call every material double-sided: what matters is
/// whether light can get behind. Decided for each shell, the triangles of a mesh that hang together
/// by their corners: random walks start on its backs, and those get out that leave the scene for a
/// sky that shines, see a light, meet something beyond the shell's surroundings, or the front of
/// something that stands inside the shell. Closed solids, boxes that stand on a floor without a
/// bottom and rugs that lie on it stay as they are. What scatters light through itself has two
/// sides in any case. Errors: cancelled, no memory for the ray tracer.
Result<std::vector<std::vector<uint8_t>>> open_backs(const scene::Scene& scene, Progress& progress);

/// The layout and the light that sides are split for.
struct SidesParams {
  atlas::UvMode uv = atlas::UvMode::automatic;
  int resolution = 512;
  bool one_page = true;  ///< more of them are laid out anew in any case
  LightIs light_is = LightIs::known;
};

/// params.uv, or unwrap where automatic meets a TEXCOORD_1 that it does not keep: a warning says
/// why then, or what `keep` keeps all the same. Errors: cancelled; what --uv keep cannot be.
Result<atlas::UvMode> settle_uv(const scene::Scene& scene, const SidesParams& params,
                                std::vector<std::string>& warnings, const Progress& progress);

/// The result of split_sides().
struct Sides {
  atlas::UvMode uv;  ///< for the layout: unwrap where TEXCOORD_1 cannot hold the light
  /// Light that a valid TEXCOORD_1 would show wrongly, where that was the question.
  std::optional<WrongSides> wrong_in_uv1;
  std::vector<std::string> warnings;
};

/// Gives open backs a side of their own (luxel/scene/sides.h), unless the file's own lightmap
/// coordinates are kept: those have one place for both. UvMode::automatic keeps them where no more
/// than kMostShownWrong of them shows wrong light. A warning says what they hold wrongly, or that
/// they are not kept. Opaque closed solids that face outwards, and into which no light comes,
/// become one-sided in any case: what stands in one, as crowns of trees do in each other, is hidden
/// where most of what it sees is a solid's back. Errors: cancelled, no memory for the ray tracer.
Result<Sides> split_sides(scene::Scene& scene, const SidesParams& params, Progress& progress);

/// Materials that split_sides has added to a scene, at the end: of which each is a copy.
/// `before`: the material numbers that each mesh had, of `known` materials.
std::vector<uint32_t> one_sided_copies(std::span<const std::vector<uint32_t>> before, size_t known,
                                       const scene::Scene& after);

}  // namespace luxel::pipeline
