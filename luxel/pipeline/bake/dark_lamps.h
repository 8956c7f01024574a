// Lamps that light nothing because of where they lie.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::pipeline {

/// Sentences for lamps none of whose rays meets a surface that it lights: those behind the front of
/// a surface, and those whose range ends before any. Three are named, and the others counted.
/// `is_hidden`: whether a place lies inside of something, as the floor under a box does; it may be
/// called by many threads at once.
std::vector<std::string> about_dark_lamps(
    const scene::Scene& scene, const trace::RayTracer& tracer,
    const std::function<bool(const scene::SurfacePoint&)>& is_hidden);

}  // namespace luxel::pipeline
