// Pictures of bakes, and how different two look.
#pragma once

#include "luxel/display/draw.h"
#include "luxel/pipeline/bake/bake_scene.h"

namespace luxel::bench {

/// A camera's picture of the bake, drawn from the texels' light as preview.png is [W/(sr m^2)].
/// Errors: cancelled.
Result<image::Image> draw_baked(const pipeline::Bake& bake, const trace::RayTracer& tracer,
                                const scene::Camera& camera, std::span<const Rgb> irradiance,
                                const display::DrawParams& params, Progress& progress);

/// Colours of the screen as light, as FLIP takes them.
image::Image on_screen(const image::Image& radiance, float exposure);

/// FLIP of two pictures as on a screen, in the mean over all pixels.
double mean_flip(const image::Image& a, const image::Image& b);

/// A JPEG file of three channels.
std::vector<std::byte> jpeg_of(const image::Image8& picture);

}  // namespace luxel::bench
