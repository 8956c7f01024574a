// Companions of a lightmap for normal maps and for things that move: how light changes with the
// normal, and probes in the air.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "luxel/base/file.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/image/image.h"
#include "luxel/light/light_around.h"
#include "luxel/pipeline/solver/solvers.h"

namespace luxel::pipeline {

/// V of E(m) = E + (m - n) . V as pictures of the lightmaps' shapes and coverage. sh1: three, of
/// V's x, y and z, a channel per colour. dominant: one, of w = V's luminance over that of E, whose
/// channels are x, y and z: E(m) = E max(0, 1 + (m - n) . w).
struct DirectionMaps {
  std::vector<std::vector<image::Image>> pictures;  ///< each with a page per lightmap
  uint64_t rays = 0;
};
/// `irradiance` is the finished lightmap's, per texel. Errors: cancelled.
Result<DirectionMaps> direction_maps(const light::TexelScene& in, std::span<const Rgb> irradiance,
                                     std::span<const uint8_t> hidden, Directional kind,
                                     uint64_t seed, Progress& progress);
/// lightmap.direction.exr, or lightmap.x.exr, .y.exr and .z.exr; of several pages
/// lightmap-0.direction.exr, ...
Result<std::vector<OutputFile>> direction_files(const DirectionMaps& maps,
                                                const std::filesystem::path& folder);

/// Probes on a grid over the scene's bounds; those inside solids are left out.
struct ProbeGrid {
  Vec3 origin;
  float spacing_m = 1;
  std::array<int, 3> count{};  ///< along x, y and z
  std::vector<int32_t> row;    ///< per point of the grid, x fastest: of `probes`, or -1
  std::vector<light::Probe> probes;
  uint64_t rays = 0;
};
/// Errors: cancelled; more than kMostProbes.
Result<ProbeGrid> probe_grid(const light::TexelScene& in, std::span<const Rgb> irradiance,
                             float spacing_m, uint64_t seed, Progress& progress);
inline constexpr double kMostProbes = 1 << 20;

/// probes.exr, a row per probe and nine columns, the coefficients; probes.json, where they stand in
/// the world of the file. `origin`: Scene::origin.
Result<std::vector<OutputFile>> probe_files(const ProbeGrid& grid, DVec3 origin,
                                            const std::filesystem::path& folder);

}  // namespace luxel::pipeline
