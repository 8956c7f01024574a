// Light that surfaces send to the eye, on the lightmap's charts: for viewers that know no lightmap.
#pragma once

#include "luxel/base/progress.h"
#include "luxel/export/baked_glb.h"
#include "luxel/pipeline/bake/bake_scene.h"

namespace luxel::pipeline {

/// The largest side of a picture in pixels: what every device takes.
inline constexpr int kLargestPicture = 4096;
/// Exposed radiance that an emissive picture holds at most, white being 1: two stops above white,
/// which leaves the dark enough of the 256 steps.
inline constexpr float kMostStrength = 4;

/// Pixels per texel of the lightmap along a side, a power of two: as many as nine tenths of the
/// textured area needs to keep the pixels of its colour and emission textures, as long as no page
/// has more than `largest` pixels a side; 1 without textures.
int picture_scale(const scene::Scene& scene, const atlas::Atlas& atlas, int largest);

/// Pictures of emission + reflected light of every page, exposed as preview.png, and combined
/// through its tone curve. Colour textures finer than a pixel are averaged over 4 x 4 points of it.
/// Each pixel takes the light of bake.lightmaps, bilinearly. Errors: cancelled.
Result<export_::LitPictures> lit_pictures(const BakeSettings& settings, const Bake& bake,
                                          Progress& progress);

}  // namespace luxel::pipeline
