// Measures the light that one place for both sides of a surface would show wrongly.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::pipeline {

/// Shares of TEXCOORD_1 that hold light which is wrong for the back of a surface. Half of a share
/// is that of the surface [m^2], half that of TEXCOORD_1, so that neither a wide ground nor a
/// thrifty layout hides what is seen.
struct WrongSides {
  /// Backs that are in the open, in other light than their fronts.
  double all = 0;
  /// Those of them that show: somebody may stand where they can be seen, with fronts below. Where
  /// the front has no light at all, because it lies within a solid, backs below are as good. What
  /// is left are undersides of grounds and the outside of rooms that have none.
  double shown = 0;
};

/// A layout of which more than this share shows wrong light is not kept. A thousandth of a preview
/// is a square of 26 pixels.
inline constexpr double kMostShownWrong = 1e-3;

/// `known`: the lights of the scene are those that will shine. `to_come`: others come later, and
/// both sides may get any light.
enum class LightIs : uint8_t { known, to_come };

/// The shares that TEXCOORD_1 would show wrongly if it were kept. `open`: the result of
/// open_backs(). Every mesh has TEXCOORD_1.
///
/// Light of both sides is traced by paths from points spread over the open triangles. It differs
/// where the difference is larger than two standard errors and a quarter of the brighter side, if
/// that has at least a tenth of the scene's mean. All bounces count: the same scene gives the same
/// shares, whatever is asked of a bake, so that bakes of parts of its light share a layout. Errors:
/// cancelled, no memory for the ray tracer.
Result<WrongSides> wrong_sides(const scene::Scene& scene,
                               const std::vector<std::vector<uint8_t>>& open, LightIs light_is,
                               Progress& progress);

}  // namespace luxel::pipeline
