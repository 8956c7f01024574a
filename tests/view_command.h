// Runs luxel-view.
#pragma once

#include "tests/command.h"

namespace luxel::testing_support {

/// `before`: what stands before it on the line, as variables of the environment.
inline CommandResult view(const std::string& arguments, const std::string& before = "") {
  return shell(before + " " LUXEL_VIEW_BINARY " " + arguments);
}

/// Whether this machine has a device that luxel can use.
inline bool has_device(const ScratchFolder& s) {
  const CommandResult r = view((s.path / "absent").string() + " --offscreen --screenshot " +
                               (s.path / "x.png").string());
  return r.err.find("device") == std::string::npos && r.err.find("Vulkan") == std::string::npos;
}

}  // namespace luxel::testing_support
