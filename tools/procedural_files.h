// Which procedural scene stands in which file of scenes/.
#pragma once

#include <string>
#include <vector>

#include "export/baked_glb.h"
#include "scene/procedural.h"

namespace luxel::tools {

struct ProceduralFile {
  std::string name;
  scene::Scene scene;
};

inline std::vector<ProceduralFile> procedural_files() {
  return {{"cornell-box.glb", scene::cornell_box()},
          {"cornell-box-empty.glb", scene::cornell_box(scene::CornellColors::pbrt, false)},
          {"furnace-box.glb", scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1})},
          {"spheres-and-cube.glb", scene::spheres_and_cube()}};
}

}  // namespace luxel::tools
