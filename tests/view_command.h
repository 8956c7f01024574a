// Runs luxel-view.
#pragma once

#include "tests/command.h"

namespace luxel::testing_support {

/// `before`: what stands before it on the line, as variables of the environment.
inline CommandResult view(const std::string& arguments, const std::string& before = "") {
  return shell(before + " " LUXEL_VIEW_BINARY " " + arguments);
}

/// `before`: on a virtual display, under the validation layer.
inline const std::string kInWindow =
    "VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation timeout 120 " LUXEL_SOURCE_DIR
    "/tools/on_virtual_display.sh";
inline bool has_virtual_display() { return shell("command -v Xvfb").code == 0; }

/// True: this machine has a device that luxel can use.
inline bool has_device(const ScratchFolder& s) {
  const CommandResult r = view((s.path / "absent").string() + " --offscreen --screenshot " +
                               (s.path / "x.png").string());
  return r.err.find("device") == std::string::npos && r.err.find("Vulkan") == std::string::npos;
}

}  // namespace luxel::testing_support
