// Scenes whose light is known without a solver. [shared/reference/exact-solutions.md]
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/scene/surface_points.h"

namespace luxel::validate {

/// A part of a scene's surfaces on which E is known.
struct ExactPart {
  std::string name;
  scene::Chosen contains;
  /// E [W/m^2] of every channel at a place of the part; where `pointwise` is false, only the mean
  /// over the part is right.
  std::function<double(Vec3 position)> irradiance;
  bool pointwise = true;
};

struct ExactCase {
  std::string name;
  std::string section;  ///< of exact-solutions.md
  scene::Scene scene;
  int resolution = 64;  ///< of the lightmap
  std::vector<ExactPart> parts;
  /// Relative distance up to which the scene's own exact light may lie from the formula (facets,
  /// finite plates).
  double slack = 0;
};

/// `exact_solutions_md` is the text of that page; without the table of its section 6 the cube,
/// whose numbers are not in closed form, is left out. Errors: cells of that table that are no
/// numbers.
Result<std::vector<ExactCase>> exact_cases(std::string_view exact_solutions_md);

}  // namespace luxel::validate
