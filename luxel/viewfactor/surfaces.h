// The named surfaces of a scene: what view factors are asked between.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/scene/scene.h"
#include "luxel/viewfactor/polygon.h"

namespace luxel::viewfactor {

/// Distance by which rounding to float may have moved a corner [m]; 0 without any corner.
double corner_rounding_m(const scene::Scene& scene);

/// An instance's triangles in the world, corners counter-clockwise from the front also where the
/// instance mirrors.
std::vector<std::array<DVec3, 3>> world_triangles(const scene::Scene& scene, uint32_t instance);

/// An instance of a mesh: a glTF node, or an `o` or `g` group of an .obj. It radiates from the
/// front of its triangles; both sides block.
struct Surface {
  std::string name;               ///< that of the instance; a second one of a name becomes name#2
  uint32_t instance = 0;          ///< in Scene::instances
  std::vector<Polygon> polygons;  ///< convex, in the world, counter-clockwise from the front
  double area_m2 = 0;
};

struct Surfaces {
  std::vector<Surface> surfaces;
  std::vector<uint32_t> of_instance;  ///< per instance; scene::kNone when it has no area
  double slack_m = 0;                 ///< corner_rounding_m of the scene
  std::vector<std::string> warnings;  ///< surfaces that were left out
};

/// Triangles of one plane are joined (merge_polygons.h); the stage "join polygons". Errors:
/// cancelled.
Result<Surfaces> surfaces_of(const scene::Scene& scene, Progress& progress);

}  // namespace luxel::viewfactor
