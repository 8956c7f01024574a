#include "tests/fuzz/targets.h"

#include <array>

#include "tests/fuzz/target_files.h"
#include "tests/fuzz/target_scenes.h"

namespace luxel::fuzz {

std::span<const Target> targets() {
  static constexpr std::array kTargets{
      Target{"bake", run_bake},
      Target{"bmp", run_picture},
      Target{"dae", run_dae},
      Target{"draco", run_draco},
      Target{"environment", run_environment},
      Target{"exr", run_exr},
      Target{"fbx", run_fbx},
      Target{"fbx_binary", run_fbx_binary},
      Target{"glb", run_glb},
      Target{"gltf", run_gltf},
      Target{"hdr", run_hdr},
      Target{"ies", run_ies},
      Target{"jpeg", run_picture},
      Target{"kept_bake", run_kept_bake},
      Target{"light_script", run_light_script},
      Target{"lxr", run_lxr},
      Target{"meshopt", run_meshopt},
      Target{"obj", run_obj},
      Target{"option_texts", run_option_texts},
      Target{"parts", run_parts},
      Target{"png", run_png},
      Target{"ply", run_ply},
      Target{"records", run_records},
      Target{"settings", run_settings},
      Target{"stl", run_stl},
      Target{"tga", run_picture},
      Target{"webp", run_webp},
      Target{"x", run_x},
  };
  return kTargets;
}

const Target* find_target(std::string_view name) {
  for (const Target& target : targets())
    if (target.name == name) return &target;
  return nullptr;
}

}  // namespace luxel::fuzz
