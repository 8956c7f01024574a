// Lines in space over a picture, hidden behind what stands before them.
#pragma once

#include <span>

#include "luxel/base/progress.h"
#include "luxel/image/image.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::display {

struct Line {
  Vec3 from, to;
  Rgb color;
};

/// What lines cover of each pixel: four channels, the colour and the share, 0 to 1. Where lines
/// cross, the one that covers most of a pixel has it. A line that lies on a surface is not hidden
/// by it: what is within a thousandth of its distance to the viewer does not count. Stops early
/// when cancelled.
image::Image draw_lines(const scene::Scene& scene, const trace::RayTracer& tracer,
                        const scene::Camera& camera, int width, int height,
                        std::span<const Line> lines, Progress& progress);

}  // namespace luxel::display
