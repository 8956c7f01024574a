#include "luxel/light/uneven_texels.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "luxel/atlas/neighbours.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/share_out.h"
#include "luxel/light/lit_points.h"

namespace luxel::light {
namespace {

struct NoisyLight {
  Rgb irradiance;
  float variance = 0;
};

bool differ(NoisyLight a, NoisyLight b, float threshold) {
  const Rgb p = a.irradiance, q = b.irradiance;
  const float difference = max_component(max(p - q, q - p));
  const float noise = std::sqrt(a.variance + b.variance);
  return difference > threshold * max_component(max(p, q)) && difference > 3 * noise;
}

/// Points of a texel at a chart's border, when it is asked whether light varies.
constexpr int kBorderPoints = 8;
/// Points of a texel where a fleck of sun may be, which can be small; and rays towards a sun's disc
/// that tell whether its sample lies in light, in shadow or between the two.
constexpr int kFleckPoints = 16, kRaysOfSample = 8;

/// Texels whose direct light differs from that of one of their eight neighbours in the same chart
/// by more than `threshold` of the brighter one, in any channel, and by more than three standard
/// deviations of their noise; in the order of the map. A straight edge of a shadow that crosses a
/// texel separates its centre from that of such a neighbour, where there is one.
std::vector<uint32_t> uneven_texels(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                    const DirectLight& direct, float threshold) {
  std::vector<uint8_t> uneven(map.texels.size());
  const auto chart_of = [&](size_t i) { return atlas.chart[map.texels[i].triangle_number]; };
  parallel_for(map.texels.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      atlas::for_neighbours(map, i, 1, [&](uint32_t j) {
        if (uneven[i] || j == i || chart_of(i) != chart_of(j)) return;
        uneven[i] = differ({direct.irradiance[i], direct.variance[i]},
                           {direct.irradiance[j], direct.variance[j]}, threshold);
      });
    }
  });
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < uneven.size(); ++i)
    if (uneven[i]) out.push_back(i);
  return out;
}

/// Texels with a place beside them that is not of their chart, but for those in `known`, which is
/// in the order of the map.
std::vector<uint32_t> border_texels(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                    std::span<const uint32_t> known) {
  const int side = map.resolution;
  const auto chart_of = [&](size_t i) { return atlas.chart[map.texels[i].triangle_number]; };
  std::vector<uint8_t> border(map.texels.size());
  parallel_for(map.texels.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const int x = int(map.texels[i].x), y = int(map.texels[i].y);
      for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
        const int u = x + dx, v = y + dy;
        const uint32_t j = u < 0 || v < 0 || u >= side || v >= side
                               ? atlas::kNone
                               : map.texel_at[size_t(v) * size_t(side) + size_t(u)];
        if (j == atlas::kNone || chart_of(i) != chart_of(j)) border[i] = 1;
      }
    }
  });
  for (const uint32_t i : known) border[i] = 0;
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < border.size(); ++i)
    if (border[i]) out.push_back(i);
  return out;
}

/// Keeps those of `which` that are marked, by their place there.
void keep_marked(std::span<const uint8_t> marked, std::vector<uint32_t>& which) {
  size_t kept = 0;
  for (size_t k = 0; k < which.size(); ++k)
    if (marked[k]) which[kept++] = which[k];
  which.resize(kept);
}

/// Keeps those of `which` whose light differs at some of a few points. Where a chart ends there is
/// no neighbour who would tell of a shadow's edge. Returns the number of rays.
Result<uint64_t> keep_uneven_at_borders(const TexelScene& in, const SupersampleParams& params,
                                        const DirectLight& direct, std::vector<uint32_t>& which,
                                        Progress& progress) {
  const PointScene place = point_scene(in);
  const atlas::Cover cover = atlas::cover_of(in.atlas, in.map, which);
  std::vector<uint8_t> uneven(which.size());
  const auto begin = [&](size_t k, PointBuffers& work) {
    atlas::spread_points(in.atlas, in.map.texels[which[k]], cover.of(k), kBorderPoints,
                         params.direct.seed, work.spread);
    receive_at_points(place, params.direct.seed, which[k], work);
    return uint64_t(0);
  };
  const auto end = [&](size_t k, PointBuffers& work) {
    const size_t i = which[k];
    uneven[k] = std::ranges::any_of(work.light, [&](const LightAt& l) {
      return differ({l.irradiance, l.variance}, {direct.irradiance[i], direct.variance[i]},
                    params.threshold);
    });
    return uint64_t(0);
  };
  progress.begin("supersample", which.size());
  LUXEL_TRY(const uint64_t rays,
            light_many_points(in, which.size(), kBorderPoints,
                              {samples_per_point(params.direct.samples)}, {begin, end}, progress));
  keep_marked(uneven, which);
  return rays;
}

bool any_differs(std::span<const LightAt> light, const LightAt& from, Rgb others, float threshold) {
  return std::ranges::any_of(light, [&](const LightAt& l) {
    return differ({others + l.irradiance, l.variance}, {others + from.irradiance, from.variance},
                  threshold);
  });
}

/// Texels whose points may lie in flecks of sun.
struct FleckScene {
  const TexelScene& in;
  const SupersampleParams& params;
  const DirectLight& direct;
  PointScene place;

  /// The sample of a texel.
  Receiver sample_of(uint32_t texel) const {
    Receiver out = own_receiver(in.elements, texel);
    out.seed = hash64(params.direct.seed, texel);
    return out;
  }
};

/// Light of punctual lights, by one ray at each of some texels' points and at the sample.
struct PunctualLook {
  std::vector<uint32_t> texels;             ///< those whose points differ
  std::vector<std::vector<LightAt>> light;  ///< of each of them, the sample's last
  uint64_t rays = 0;
};

/// Looks at texels, the first of which is number `first` of `cover`.
Result<PunctualLook> look_at_punctual_lights(const FleckScene& from, const atlas::Cover& cover,
                                             size_t first, std::span<const uint32_t> texels,
                                             Progress& progress) {
  const TexelScene& in = from.in;
  const SupersampleParams& params = from.params;
  PunctualLook out{{texels.begin(), texels.end()},
                   std::vector<std::vector<LightAt>>(texels.size())};
  std::vector<uint8_t> differs(texels.size());
  const auto begin = [&](size_t k, PointBuffers& work) {
    atlas::spread_points(in.atlas, in.map.texels[texels[k]], cover.of(first + k), kFleckPoints,
                         params.direct.seed, work.spread);
    receive_at_points(from.place, params.direct.seed, texels[k], work);
    work.receivers.push_back(from.sample_of(texels[k]));
    return uint64_t(0);
  };
  const auto end = [&](size_t k, PointBuffers& work) {
    differs[k] = any_differs(work.light, work.light.back(), {}, params.threshold);
    if (differs[k]) out.light[k] = work.light;
    return uint64_t(0);
  };
  LUXEL_TRY(out.rays,
            light_many_points(in, texels.size(), kFleckPoints + 1,
                              {.samples = 1, .punctual_alone = true}, {begin, end}, progress));
  keep_marked(differs, out.texels);
  std::erase_if(out.light, [](const std::vector<LightAt>& l) { return l.empty(); });
  return out;
}

/// Leaves those of `look.texels` that differ from their samples by more than the noise of those,
/// which are looked at with more rays. Returns the number of rays.
Result<uint64_t> keep_beyond_noise(const FleckScene& from, PunctualLook& look, Progress& progress) {
  std::vector<uint8_t> flecked(look.texels.size());
  const auto begin = [&](size_t k, PointBuffers& work) {
    work.receivers.push_back(from.sample_of(look.texels[k]));
    return uint64_t(0);
  };
  const auto end = [&](size_t k, PointBuffers& work) {
    const LightAt& own = work.light.front();
    const Rgb others = max(from.direct.irradiance[look.texels[k]] - own.irradiance, Rgb{});
    flecked[k] = any_differs(look.light[k], own, others, from.params.threshold);
    return uint64_t(0);
  };
  LUXEL_TRY(const uint64_t rays,
            light_many_points(from.in, look.texels.size(), 1,
                              {.samples = kRaysOfSample, .punctual_alone = true},
                              {.begin = begin, .end = end, .advances = false}, progress));
  keep_marked(flecked, look.texels);
  return rays;
}

/// Keeps those of `which` in which some points are in the light of a punctual light and others are
/// not: a ray each tells. In a penumbra one ray does not, and neighbours do: what differs by no
/// more than the noise of the sample's own few rays counts for nothing. Returns the number of rays.
Result<uint64_t> keep_flecked(const TexelScene& in, const SupersampleParams& params,
                              const DirectLight& direct, std::vector<uint32_t>& which,
                              Progress& progress) {
  // The light of so many is there at a time: 12 MB at most.
  constexpr size_t kTexelsAtATime = size_t(1) << 15;
  const FleckScene from{in, params, direct, point_scene(in)};
  const atlas::Cover cover = atlas::cover_of(in.atlas, in.map, which);
  std::vector<uint32_t> kept;
  uint64_t rays = 0;
  progress.begin("supersample", which.size());
  for (size_t first = 0; first < which.size(); first += kTexelsAtATime) {
    const size_t count = std::min(kTexelsAtATime, which.size() - first);
    // Mostly all points and the sample are in the light, or none is.
    LUXEL_TRY(PunctualLook look,
              look_at_punctual_lights(from, cover, first, std::span(which).subspan(first, count),
                                      progress));
    LUXEL_TRY(const uint64_t again, keep_beyond_noise(from, look, progress));
    kept.insert(kept.end(), look.texels.begin(), look.texels.end());
    rays += look.rays + again;
  }
  which = std::move(kept);
  return rays;
}

/// Those of `among` that are not in `known` and face a punctual light; all in the order of the map.
std::vector<uint32_t> facing_punctual_lights(const TexelScene& in, std::span<const uint32_t> among,
                                             std::span<const uint32_t> known) {
  if (in.lights.punctual.empty()) return {};
  std::vector<uint32_t> out;
  std::ranges::set_difference(among, known, std::back_inserter(out));
  std::vector<uint8_t> faces(out.size());
  parallel_for(out.size(), 1024, [&](size_t begin, size_t end) {
    ShadowRayBatch aimed;
    for (size_t k = begin; k < end; ++k) {
      clear(aimed);
      aim_at_punctual_lights(in.lights, 1, own_receiver(in.elements, out[k]), aimed);
      faces[k] = !aimed.rays.empty();
    }
  });
  keep_marked(faces, out);
  return out;
}

}  // namespace

Result<UnevenTexels> texels_to_average(const TexelScene& in, std::span<const uint32_t> among,
                                       const SupersampleParams& params, const DirectLight& direct,
                                       Progress& progress) {
  const std::vector<uint32_t> all = uneven_texels(in.atlas, in.map, direct, params.threshold);
  std::vector<uint32_t> uneven, borders, known;
  UnevenTexels out;
  std::ranges::set_intersection(all, among, std::back_inserter(uneven));
  std::ranges::set_intersection(border_texels(in.atlas, in.map, uneven), among,
                                std::back_inserter(borders));
  Team* const team = params.direct.team;
  LUXEL_TRY(const uint64_t rays,
            keep_in_shares(team, borders, progress, [&](std::vector<uint32_t>& some) {
              return keep_uneven_at_borders(in, params, direct, some, progress);
            }));
  std::ranges::merge(uneven, borders, std::back_inserter(known));
  // Flecks of sun between leaves are smaller than texels: the samples of a texel and of all its
  // neighbours can miss them. Soft light has none.
  std::vector<uint32_t> flecks = facing_punctual_lights(in, among, known);
  LUXEL_TRY(const uint64_t of_flecks,
            keep_in_shares(team, flecks, progress, [&](std::vector<uint32_t>& some) {
              return keep_flecked(in, params, direct, some, progress);
            }));
  std::ranges::merge(known, flecks, std::back_inserter(out.texels));
  out.rays = rays + of_flecks;
  return out;
}

}  // namespace luxel::light
