#include "luxel/scene/procedural.h"

namespace luxel::scene {

std::vector<NamedScene> procedural_scenes() {
  return {{"bumps.glb", bumps(false)},
          {"bumps-in-relief.glb", bumps(true)},
          {"cornell-box.glb", cornell_box()},
          {"cornell-box-empty.glb", cornell_box(CornellColors::pbrt, false)},
          {"closed-corner.glb", closed_corner()},
          {"foliage.glb", foliage()},
          {"furnace-box.glb", furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1})},
          {"office.glb", office()},
          {"radiosity-box.glb", radiosity_box()},
          {"radiosity-box-with-shapes.glb", radiosity_box_with_shapes()},
          {"spheres-and-cube.glb", spheres_and_cube()},
          {"tiled-kit.glb", tiled_kit()}};
}

}  // namespace luxel::scene
