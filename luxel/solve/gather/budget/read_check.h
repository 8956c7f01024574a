// Checks the light that rays read in the map against that of the places they meet.
//
// Between texels light is bilinear, and a texel holds that of one place or its mean. Where light
// varies within a texel, as beside a lamp, rays read too much or too little, and they do so in
// every bounce. No other rays of the same map would tell. So some places that rays meet are looked
// at themselves: how much light do they get from lights, and from the map by rays of their own? If
// they should send more than is read there, that is missing at its source, as if lamps were weaker;
// what bounces make of it is missing in the same proportion. docs/method/gather.md
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/light/texel_scene.h"
#include "luxel/solve/gather/rays/traced_hits.h"
#include "luxel/transport/own_side.h"

namespace luxel::gather {

struct ReadCheckParams {
  uint64_t rays = 1 << 19;   ///< about so many, shadow rays included
  bool follows_near = true;  ///< as TraceParams has it: near hits read nothing
  uint64_t seed = 1;
  std::filesystem::path scratch_folder = ".";
};

/// Rays that a bake of so many samples in all spares for the check: few beside its own; 0: the
/// check is not worth it. Where an error is asked for there are more, for noise will be small
/// beside the error of texels. There are more, too, where bounces between elements of these
/// reflectances make that error tenfold: 1 / (1 - rho) times that of one reflection.
uint64_t check_rays(uint64_t samples, bool asks_for_error, std::span<const Rgb> reflectance);
/// Memory of so many of them [bytes].
uint64_t check_bytes(uint64_t rays);

/// Places that rays of texels meet, evenly over the rays of all texels that are not hidden.
struct ReadCheck {
  std::vector<StoredHit> read;   ///< where those rays read the map
  std::vector<Rgb> reflectance;  ///< of the places themselves
  std::vector<Rgb> direct;       ///< E straight from lights, noisy [W/m^2]
  /// The numbers of the rays that met them. Rays are in the order of their texels: so many that
  /// follow one another, a group, start at one texel or at a few beside each other.
  std::vector<uint32_t> ray;
  size_t rays_of_group = 0;
  std::vector<uint32_t> texel_of_group, chart_of_group;  ///< a texel of each, and its chart
  size_t charts = 0;
  TracedHits hits;  ///< of a few rays from each

  size_t size() const { return read.size(); }
};

/// `hits` says which texels are hidden. Places that scatter light through are left out. Errors:
/// cancelled.
Result<ReadCheck> make_read_check(const light::TexelScene& in, const transport::OwnSides& sides,
                                  const TracedHits& hits, const ReadCheckParams& params,
                                  Progress& progress);

/// The map's light, by which places are checked: E per element of the map.
struct LightOfMap {
  const atlas::TexelMap& map;
  const transport::Elements& elements;
  const TracedHits& hits;
  std::span<const StoredHit> behind;
  std::span<const Rgb> irradiance;
};

/// The part of itself by which gathered light is too bright (> 0) or too dark, and how well that is
/// known.
struct ReadError {
  double part = 0, standard_error = INFINITY;
  /// Light that is read may be right in the mean and yet wrong for each texel, which sees some
  /// places and not others: above a row of slats one meets bright stripes where another meets the
  /// dark between them. The mean square of what texels read more or less than `part` says, over
  /// that of gathered light; 0 where nothing is found.
  double square_apart = 0;
  /// As parts of the texels' own light, or of darkest_light(), per chart: a ceiling over
  /// slats has more of it than the floor. Of few rays the mean over all charts counts. Empty:
  /// nothing is measured.
  std::vector<float> relative_square_apart{};
};
/// Errors: the file of hits cannot be read, cancelled.
Result<ReadError> read_error(const ReadCheck& check, const LightOfMap& light, Progress& progress);

}  // namespace luxel::gather
