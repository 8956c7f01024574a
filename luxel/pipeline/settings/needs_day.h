// Scenes in which something glows that lights next to nothing: a badge, tail lamps.
#pragma once

#include <string>

#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::pipeline {

/// Says what emits in a scene of no other light, and how little it lights, where that leaves nine
/// tenths of what can be seen black and half of that lies under the open sky; empty: it lights
/// enough, or no day would get in. Errors: those of the tracer.
Result<std::string> about_faint_emission(const scene::Scene& scene);

}  // namespace luxel::pipeline
