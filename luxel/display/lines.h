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

/// Draws lines into four channels: the colour, and the share of a pixel that they cover, 0 to 1.
/// Where lines cross, the one that covers most of a pixel has it. A line that lies on a surface is
/// not hidden by it: surfaces hide lines that are farther away by over a thousandth of their
/// distance. Stops early when cancelled.
image::Image draw_lines(const scene::Scene& scene, const trace::RayTracer& tracer,
                        const scene::Camera& camera, int width, int height,
                        std::span<const Line> lines, Progress& progress);

}  // namespace luxel::display
