#include "luxel/light/supersample.h"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <numeric>
#include <optional>

#include "luxel/atlas/neighbours.h"
#include "luxel/base/check.h"
#include "luxel/base/free_memory.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/light/kept_light.h"
#include "luxel/light/points_of_texels.h"
#include "luxel/light/shadow_rays.h"

namespace luxel::light {
namespace {

/// Texels of a part: each needs hundreds of rays, and a part is what a checkpoint keeps.
constexpr size_t kSupersampleGrain = 16;
/// Any number: it sets the random numbers of points apart from others of the same seed.
constexpr uint64_t kPointSeed = 0x70e1;

/// Light at the points of one texel.
struct PointLight {
  Vec3 position;
  Rgb irradiance;
  float variance = 0;
};

/// Estimates the variance of the mean's luminance. Points are stratified: what counts is how much
/// the light varies within each one's share of the texel, and half the squared difference to the
/// nearest other point stands for that, and for the noise of the point itself.
float variance_of_mean(std::span<const PointLight> points) {
  const size_t n = points.size();
  if (n == 1) return points[0].variance;
  double sum = 0;
  for (size_t i = 0; i < n; ++i) {
    size_t nearest = i == 0 ? 1 : 0;
    const auto distance2 = [&](size_t j) {
      const Vec3 d = points[j].position - points[i].position;
      return dot(d, d);
    };
    for (size_t j = 0; j < n; ++j)
      if (j != i && distance2(j) < distance2(nearest)) nearest = j;
    const double d =
        double(luminance(points[i].irradiance)) - double(luminance(points[nearest].irradiance));
    sum += 0.5 * d * d;
  }
  return float(sum / (double(n) * double(n)));
}

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

bool is_dark(Rgb light) { return max_component(light) <= 0; }

int samples_per_point(int samples) { return std::max(std::min(samples, 8), samples / 8); }

/// Points of a texel at a chart's border, when it is asked whether light varies.
constexpr int kBorderPoints = 8;
/// Points of a texel where a fleck of sun may be, which can be small; and rays towards a sun's disc
/// that tell whether its sample lies in light, in shadow or between the two.
constexpr int kFleckPoints = 16, kRaysOfSample = 8;

/// Buffers of one thread.
struct PointBuffers {
  std::vector<scene::SurfacePoint> spread;
  std::vector<uint8_t> on_side;  ///< per point of spread
  std::vector<Receiver> receivers;
  std::vector<LightAt> light;
  ShadowRayBatch batch;
};

/// Makes work.receivers of work.spread, the points of texel `i`, and room for their light.
void receive_at_points(const PointScene& place, uint64_t seed, size_t i, PointBuffers& work) {
  work.receivers.clear();
  for (const scene::SurfacePoint& p : work.spread) {
    const uint64_t own = hash64(hash64(seed, kPointSeed + work.receivers.size()), i);
    work.receivers.push_back(receiver_at(place, transport::smooth_point(place.scene, p), own));
  }
  work.light.resize(work.receivers.size());
}

/// The direct light at work.spread, the points of texel `i`.
void light_points(const PointScene& place, const Lights& lights, const DirectParams& each, size_t i,
                  PointBuffers& work) {
  receive_at_points(place, each.seed, i, work);
  direct_light_at({place.scene, lights, place.tracer, place.diagonal_m}, each, work.receivers,
                  work.batch, work.light);
}

}  // namespace

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

Result<Footprints> footprints(const TexelScene& in, int points, uint64_t seed, Progress& progress) {
  LUXEL_CHECK(points >= 1);
  std::vector<uint32_t> all(in.map.texels.size());
  std::iota(all.begin(), all.end(), 0u);
  const atlas::Cover cover = atlas::cover_of(in.atlas, in.map, all);
  const PointScene place = point_scene(in);
  std::vector<std::vector<Receiver>> found(all.size());
  progress.begin("footprints", all.size());
  parallel_for(all.size(), kSupersampleGrain, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    std::vector<scene::SurfacePoint> spread;
    std::vector<uint8_t> on_side;
    // Points of each texel on its sample's side of walls that lie in the open; its own sample where
    // there are none.
    for (size_t i = begin; i < end; ++i) {
      const Receiver own = own_receiver(place, in.elements, i);
      if (!is_enclosed(place, own, kEnclosureRaysOfTexel)) {
        atlas::spread_points(in.atlas, in.map.texels[i], cover.of(i), points, seed, spread);
        find_on_side(in, i, spread, on_side);
        for (size_t k = 0; k < spread.size(); ++k) {
          if (!on_side[k]) continue;
          const Receiver r = receiver_at(place, transport::smooth_point(in.scene, spread[k]), 0);
          if (!is_enclosed(place, r)) found[i].push_back(r);
        }
      }
      if (found[i].empty()) found[i].push_back(own);
    }
    progress.advance(end - begin);
  });
  LUXEL_TRY_STATUS(stopped(progress));
  // One array of all, freed texel by texel, so that both are never whole at a time.
  Footprints out;
  out.first.push_back(0);
  for (size_t i = 0; i < all.size(); ++i) {
    for (const Receiver& r : found[i]) {
      out.points.position.push_back(r.position), out.points.normal.push_back(r.normal);
      out.points.geometric_normal.push_back(r.geometric_normal);
    }
    out.first.push_back(uint32_t(out.points.size()));
    free_memory(found[i]);
  }
  return out;
}

namespace {

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

/// Keeps the texels of `which` for which is_uneven(texel, cover, work, traced) says so, and adds
/// its rays to `traced`. Returns the number of rays.
template <class IsUneven>
Result<uint64_t> keep_uneven(const TexelScene& in, std::vector<uint32_t>& which, Progress& progress,
                             const IsUneven& is_uneven) {
  const atlas::Cover cover = atlas::cover_of(in.atlas, in.map, which);
  std::atomic<uint64_t> rays{0};
  std::vector<uint8_t> uneven(which.size());
  progress.begin("supersample", which.size());
  parallel_for(which.size(), kSupersampleGrain, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    PointBuffers work;
    uint64_t traced = 0;
    for (size_t k = begin; k < end; ++k) uneven[k] = is_uneven(which[k], cover.of(k), work, traced);
    rays += traced;
    progress.advance(end - begin);
  });
  LUXEL_TRY_STATUS(stopped(progress));
  keep_marked(uneven, which);
  return uint64_t(rays);
}

/// Keeps those of `which` whose light differs at some of a few points. Where a chart ends there is
/// no neighbour who would tell of a shadow's edge. Returns the number of rays.
Result<uint64_t> keep_uneven_at_borders(const TexelScene& in, const SupersampleParams& params,
                                        const DirectLight& direct, std::vector<uint32_t>& which,
                                        Progress& progress) {
  const PointScene place = point_scene(in);
  DirectParams each = params.direct;
  each.samples = samples_per_point(params.direct.samples);
  return keep_uneven(in, which, progress,
                     [&](uint32_t i, const auto& cover, PointBuffers& work, uint64_t& traced) {
                       atlas::spread_points(in.atlas, in.map.texels[i], cover, kBorderPoints,
                                            each.seed, work.spread);
                       light_points(place, in.lights, each, i, work);
                       traced += work.batch.rays.size();
                       return std::ranges::any_of(work.light, [&](const LightAt& l) {
                         return differ({l.irradiance, l.variance},
                                       {direct.irradiance[i], direct.variance[i]},
                                       params.threshold);
                       });
                     });
}

/// Keeps those of `which` in which some points are in the light of a punctual light and others are
/// not: a ray each tells. In a penumbra one ray does not, and neighbours do: what differs by no
/// more than the noise of the sample's own few rays counts for nothing. Returns the number of rays.
Result<uint64_t> keep_flecked(const TexelScene& in, const SupersampleParams& params,
                              const DirectLight& direct, std::vector<uint32_t>& which,
                              Progress& progress) {
  const PointScene place = point_scene(in);
  const DirectScene lit{in.scene, in.lights, in.tracer, place.diagonal_m};
  const uint64_t seed = params.direct.seed;
  return keep_uneven(
      in, which, progress,
      [&](uint32_t i, const auto& cover, PointBuffers& work, uint64_t& traced) {
        atlas::spread_points(in.atlas, in.map.texels[i], cover, kFleckPoints, seed, work.spread);
        receive_at_points(place, seed, i, work);
        work.receivers.push_back(own_receiver(place, in.elements, i));
        work.receivers.back().seed = hash64(seed, i);
        work.light.emplace_back();
        punctual_light_at(lit, 1, work.receivers, work.batch, work.light);
        traced += work.batch.rays.size();
        const auto any_differs = [&](const LightAt& from, Rgb others) {
          return std::ranges::any_of(work.light, [&](const LightAt& l) {
            return differ({others + l.irradiance, l.variance},
                          {others + from.irradiance, from.variance}, params.threshold);
          });
        };
        // Mostly all points and the sample are in the light, or none is.
        if (!any_differs(LightAt(work.light.back()), {})) return false;
        LightAt own;
        punctual_light_at(lit, kRaysOfSample, std::span(work.receivers).last(1), work.batch,
                          {&own, 1});
        traced += work.batch.rays.size();
        return any_differs(own, max(direct.irradiance[i] - own.irradiance, Rgb{}));
      });
}

/// Those of `among` that are not in `known` and face a punctual light; all in the order of the map.
std::vector<uint32_t> facing_punctual_lights(const TexelScene& in, std::span<const uint32_t> among,
                                             std::span<const uint32_t> known) {
  if (in.lights.punctual.empty()) return {};
  std::vector<uint32_t> out;
  std::ranges::set_difference(among, known, std::back_inserter(out));
  const PointScene place = point_scene(in);
  std::vector<uint8_t> faces(out.size());
  parallel_for(out.size(), 1024, [&](size_t begin, size_t end) {
    ShadowRayBatch aimed;
    for (size_t k = begin; k < end; ++k) {
      clear(aimed);
      aim_at_punctual_lights(in.lights, 1, own_receiver(place, in.elements, out[k]), aimed);
      faces[k] = !aimed.rays.empty();
    }
  });
  keep_marked(faces, out);
  return out;
}

}  // namespace

Result<Supersampled> supersample(const TexelScene& in, const SupersampleParams& params,
                                 DirectLight& direct, Progress& progress) {
  std::vector<uint32_t> all(in.map.texels.size());
  std::iota(all.begin(), all.end(), 0u);
  return supersample(in, all, params, direct, progress);
}

Result<Supersampled> supersample(const TexelScene& in, std::span<const uint32_t> among,
                                 const SupersampleParams& params, DirectLight& direct,
                                 Progress& progress) {
  if (params.points == 1) return Supersampled{};
  const std::vector<uint32_t> all = uneven_texels(in.atlas, in.map, direct, params.threshold);
  std::vector<uint32_t> uneven, borders, known, which;
  std::ranges::set_intersection(all, among, std::back_inserter(uneven));
  std::ranges::set_intersection(border_texels(in.atlas, in.map, uneven), among,
                                std::back_inserter(borders));
  LUXEL_TRY(const uint64_t rays, keep_uneven_at_borders(in, params, direct, borders, progress));
  std::ranges::merge(uneven, borders, std::back_inserter(known));
  // Flecks of sun between leaves are smaller than texels: the samples of a texel and of all its
  // neighbours can miss them. Soft light has none.
  std::vector<uint32_t> flecks = facing_punctual_lights(in, among, known);
  LUXEL_TRY(const uint64_t of_flecks, keep_flecked(in, params, direct, flecks, progress));
  std::ranges::merge(known, flecks, std::back_inserter(which));
  LUXEL_TRY(Supersampled out, average_texels(in, which, params, direct, progress));
  out.rays += rays + of_flecks;
  return out;
}

namespace {

KeptStage kept_stage(const SupersampleParams& params, std::span<const uint32_t> which,
                     const DirectLight& direct) {
  if (params.direct.parts == nullptr) return {};
  Digest digest;
  digest.add("supersample"), digest.add(params.points), add_to(digest, params.direct);
  digest.add(which);
  for (const uint32_t i : which) digest.add(is_dark(direct.irradiance[i]));
  return {params.direct.parts, digest.value()};
}

/// Returns the number of rays; fills one flag per texel, whether it was averaged.
std::optional<uint64_t> find_part(const KeptStage& kept, size_t part,
                                  std::span<const uint32_t> which, std::span<uint8_t> is_averaged,
                                  DirectLight& direct) {
  const auto bytes = kept.find(part);
  if (!bytes) return std::nullopt;
  ByteReader in{*bytes};
  const uint64_t rays = in.get_value<uint64_t>();
  std::vector<uint8_t> flags(is_averaged.size());
  in.get(std::span(flags));
  if (!in.ok || !get_light(in, which, direct)) return std::nullopt;
  std::copy(flags.begin(), flags.end(), is_averaged.begin());
  return rays;
}

void keep_part(const KeptStage& kept, size_t part, std::span<const uint32_t> which,
               std::span<const uint8_t> is_averaged, const DirectLight& direct, uint64_t rays) {
  if (!kept.wants()) return;
  ByteWriter out;
  out.put_value(rays);
  out.put(is_averaged);
  put_light(direct, which, out);
  kept.keep(part, out.bytes);
}

}  // namespace

Result<Supersampled> average_texels(const TexelScene& in, std::span<const uint32_t> which,
                                    const SupersampleParams& params, DirectLight& direct,
                                    Progress& progress) {
  LUXEL_CHECK(params.points >= 1);
  const atlas::Cover cover = atlas::cover_of(in.atlas, in.map, which);
  const PointScene place = point_scene(in);
  DirectParams each = params.direct;
  each.samples = samples_per_point(params.direct.samples);
  std::atomic<uint64_t> rays{0};
  std::vector<uint8_t> is_averaged(which.size());
  const KeptStage kept = kept_stage(params, which, direct);
  progress.begin("supersample", which.size());
  parallel_for(which.size(), kSupersampleGrain, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    const std::span<const uint32_t> these = which.subspan(begin, end - begin);
    const std::span<uint8_t> averaged = std::span(is_averaged).subspan(begin, end - begin);
    if (const auto found = find_part(kept, begin / kSupersampleGrain, these, averaged, direct)) {
      rays += *found;
      return progress.skip(end - begin);
    }
    PointBuffers work;
    std::vector<PointLight> points;
    std::vector<Rgb> by_layer(each.layers ? each.layers->size() : 0);
    uint64_t traced = 0;
    for (size_t k = begin; k < end; ++k) {
      const uint32_t i = which[k];
      const Receiver own = own_receiver(place, in.elements, i);
      // A texel whose own sample lies inside a solid is hidden, and keeps its light.
      if (is_dark(direct.irradiance[i])) {
        traced += uint64_t(kEnclosureRaysOfTexel);
        if (is_enclosed(place, own, kEnclosureRaysOfTexel)) continue;
      }
      const bool near_back_faces = sees_backs(place, own);
      traced += uint64_t(kEnclosureRays);
      // The light of points all over its footprint, without those inside of solids or beyond walls.
      points.clear();
      std::ranges::fill(by_layer, Rgb{});
      atlas::spread_points(in.atlas, in.map.texels[i], cover.of(k), params.points, each.seed,
                           work.spread);
      light_points(place, in.lights, each, i, work);
      traced += work.batch.rays.size() + find_on_side(in, i, work.spread, work.on_side);
      for (size_t j = 0; j < work.light.size(); ++j) {
        if (!work.on_side[j]) continue;
        // Where a wall stands on the surface, its inside is dark, and nobody sees it; under the
        // edge of a shell without a bottom, whose backs the texel sees, it need not be dark.
        const LightAt& light = work.light[j];
        const bool doubtful = near_back_faces || is_dark(light.irradiance);
        traced += doubtful ? uint64_t(kEnclosureRays) : 0;
        if (doubtful && is_enclosed(place, work.receivers[j])) continue;
        points.push_back({work.receivers[j].position, light.irradiance, light.variance});
        if (each.layers) add_light_by_layer(work.batch, j, *each.layers, {1, 1, 1}, by_layer);
      }
      // Their mean takes the place of the light of the sample.
      if (points.empty()) continue;
      Rgb sum{};
      for (const PointLight& p : points) sum += p.irradiance;
      direct.irradiance[i] = sum / float(points.size());
      direct.variance[i] = direct.split_variance[i] = variance_of_mean(points);
      for (size_t l = 0; l < by_layer.size(); ++l)
        direct.layers_of(i, *each.layers)[l] = by_layer[l] / float(points.size());
      is_averaged[k] = 1;
    }
    rays += traced;
    keep_part(kept, begin / kSupersampleGrain, these, averaged, direct, traced);
    progress.advance(end - begin);
  });
  LUXEL_TRY_STATUS(stopped(progress));
  Supersampled out{{}, rays};
  for (size_t k = 0; k < which.size(); ++k)
    if (is_averaged[k]) out.texels.push_back(which[k]);
  return out;
}

}  // namespace luxel::light
