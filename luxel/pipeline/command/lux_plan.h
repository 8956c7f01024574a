// Plans of work planes: false colours, isolux lines, walls, labels and a legend.
#pragma once

#include "luxel/image/codec.h"
#include "luxel/pipeline/command/lux.h"

namespace luxel::pipeline {

/// One plan per floor, from above (x to the right, z down), all in one scale. Walls are what the
/// plane cuts of the scene. Between points E is bilinear within a room; beyond the outermost points
/// it is that of the nearest one of their cell. Floors lie below each other.
image::Image8 lux_plan(const scene::Scene& scene, const LuxSettings& settings,
                       const LuxReport& report);

}  // namespace luxel::pipeline
