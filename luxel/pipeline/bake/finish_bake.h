// The steps after the solver: leaks repaired, seams stitched, lightmaps made.
#pragma once

#include "luxel/pipeline/bake/bake_scene.h"

namespace luxel::pipeline {

/// Repairs the light of hidden texels and at seams (settings.repair_leaks, settings.stitch),
/// without mixing any of `regions` (connected_texels(), or none). Then makes the lightmaps, those
/// of layers, and the pictures of texels and errors that are asked for. All members of a team do so
/// with the same light; what rays it takes is shared out. Errors: cancelled, another member gives
/// up.
Status repair_light(const BakeSettings& settings, const trace::RayTracer& tracer,
                    std::span<const uint32_t> regions, Bake& bake, Progress& progress, Team* team);

/// Hidden texels are refilled as far as a bilinear lookup from outside can reach.
inline constexpr int kRefillRings = 2;

/// Directional maps and probes where they are asked for, of the light that repair_light() left.
/// Errors: too little memory, cancelled.
Status add_directions(const BakeSettings& settings, const light::TexelScene& input, Bake& bake,
                      Progress& progress);

}  // namespace luxel::pipeline
