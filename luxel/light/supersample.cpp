#include "luxel/light/supersample.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "luxel/base/check.h"
#include "luxel/base/free_memory.h"
#include "luxel/base/job.h"
#include "luxel/base/parallel.h"
#include "luxel/light/kept_light.h"
#include "luxel/light/lit_points.h"
#include "luxel/light/uneven_texels.h"

namespace luxel::light {

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
      const Receiver own = own_receiver(in.elements, i);
      if (!is_enclosed(place, own, kEnclosureRaysOfTexel)) {
        atlas::spread_points(in.atlas, in.map.texels[i], cover.of(i), points, seed, spread);
        find_on_side(in, i, spread, on_side);
        for (size_t k = 0; k < spread.size(); ++k) {
          if (!on_side[k]) continue;
          const Receiver r = receiver_at(transport::smooth_point(in.scene, spread[k]), 0);
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
  LUXEL_TRY(const UnevenTexels which, texels_to_average(in, among, params, direct, progress));
  LUXEL_TRY(Supersampled out, average_texels(in, which.texels, params, direct, progress));
  out.rays += which.rays;
  return out;
}

namespace {

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

bool is_dark(Rgb light) { return max_component(light) <= 0; }

KeptStage kept_stage(const SupersampleParams& params, std::span<const uint32_t> which,
                     const DirectLight& direct) {
  if (params.direct.parts == nullptr) return {};
  Digest digest;
  digest.add("supersample"), digest.add(params.points), add_to(digest, params.direct);
  digest.add(which);
  for (const uint32_t i : which) digest.add(is_dark(direct.irradiance[i]));
  return {params.direct.parts, digest.value()};
}

/// Averages light over the points of some texels.
struct Averaging {
  const TexelScene& in;
  const SupersampleParams& params;
  std::span<const uint32_t> which;
  const atlas::Cover& cover;
  PointScene place;
  DirectLight& direct;
  // Per texel of `which`: whether its sample has backs before it; and whether it was averaged.
  std::vector<uint8_t> near_back_faces, is_averaged;

  LightAsked asked() const { return {samples_per_point(params.direct.samples)}; }
  std::span<const uint32_t> texels_of(size_t part) const {
    const size_t first = part * kSupersampleGrain;
    return which.subspan(first, std::min(kSupersampleGrain, which.size() - first));
  }
  std::span<uint8_t> is_averaged_of(size_t part) {
    return std::span(is_averaged).subspan(part * kSupersampleGrain, texels_of(part).size());
  }
  uint64_t begin(size_t k, PointBuffers& work);
  uint64_t end(size_t k, PointBuffers& work);
};

/// WorkOnPoints::begin(): points all over the texel's footprint.
uint64_t Averaging::begin(size_t k, PointBuffers& work) {
  const uint32_t i = which[k];
  const Receiver own = own_receiver(in.elements, i);
  uint64_t rays = 0;
  // A texel whose own sample lies inside a solid is hidden, and keeps its light.
  if (is_dark(direct.irradiance[i])) {
    rays += uint64_t(kEnclosureRaysOfTexel);
    if (is_enclosed(place, own, kEnclosureRaysOfTexel)) return rays;
  }
  near_back_faces[k] = sees_backs(place, own);
  const uint64_t seed = params.direct.seed;
  atlas::spread_points(in.atlas, in.map.texels[i], cover.of(k), params.points, seed, work.spread);
  receive_at_points(place, seed, i, work);
  return rays + uint64_t(kEnclosureRays) + find_on_side(in, i, work.spread, work.on_side);
}

/// WorkOnPoints::end(): the light of its points, without those inside of solids or beyond walls;
/// their mean takes the place of the light of the sample. Where light is told apart, work.batch
/// has the points' shadow rays.
uint64_t Averaging::end(size_t k, PointBuffers& work) {
  const uint32_t i = which[k];
  const LightLayers* layers = params.direct.layers;
  std::vector<PointLight> points;
  std::vector<Rgb> by_layer(layers ? layers->size() : 0);
  uint64_t rays = 0;
  for (size_t j = 0; j < work.light.size(); ++j) {
    if (!work.on_side[j]) continue;
    // Where a wall stands on the surface, its inside is dark, and nobody sees it; under the
    // edge of a shell without a bottom, whose backs the texel sees, it need not be dark.
    const LightAt& light = work.light[j];
    const bool doubtful = near_back_faces[k] || is_dark(light.irradiance);
    rays += doubtful ? uint64_t(kEnclosureRays) : 0;
    if (doubtful && is_enclosed(place, work.receivers[j])) continue;
    points.push_back({work.receivers[j].position, light.irradiance, light.variance});
    if (layers) add_light_by_layer(work.batch, j, *layers, {1, 1, 1}, by_layer);
  }
  if (points.empty()) return rays;
  Rgb sum{};
  for (const PointLight& p : points) sum += p.irradiance;
  direct.irradiance[i] = sum / float(points.size());
  direct.variance[i] = direct.split_variance[i] = variance_of_mean(points);
  for (size_t l = 0; l < by_layer.size(); ++l)
    direct.layers_of(i, *layers)[l] = by_layer[l] / float(points.size());
  is_averaged[k] = 1;
  return rays;
}

/// The parts of the texels, but for what averages: which of them were, and their light.
PartWork parts_of(Averaging& averaging) {
  PartWork out;
  out.count = (averaging.which.size() + kSupersampleGrain - 1) / kSupersampleGrain;
  out.units = [&](size_t part) { return averaging.texels_of(part).size(); };
  out.put = [&](size_t part, ByteWriter& to) {
    to.put(std::span<const uint8_t>(averaging.is_averaged_of(part)));
    put_light(averaging.direct, averaging.texels_of(part), to);
  };
  out.get = [&](size_t part, ByteReader& from) {
    std::vector<uint8_t> flags(averaging.texels_of(part).size());
    from.get(std::span(flags));
    if (!from.ok || !get_light(from, averaging.texels_of(part), averaging.direct)) return false;
    std::ranges::copy(flags, averaging.is_averaged_of(part).begin());
    return true;
  };
  return out;
}

/// Averages on in.light_device, whose parts are kept for the processor. Returns the number of rays,
/// which every part gets a share of. Errors: as average_texels().
Result<uint64_t> average_on_device(Averaging& averaging, Progress& progress) {
  const std::span<const uint32_t> which = averaging.which;
  const KeptStage kept = kept_stage(averaging.params, which, averaging.direct);
  const WorkOnPoints texels{[&](size_t k, PointBuffers& work) { return averaging.begin(k, work); },
                            [&](size_t k, PointBuffers& work) { return averaging.end(k, work); }};
  LUXEL_TRY(const uint64_t rays,
            light_many_points(averaging.in, which.size(), size_t(averaging.params.points),
                              averaging.asked(), texels, progress));
  const PartWork parts = parts_of(averaging);
  for (size_t part = 0; part < parts.count && kept.wants(); ++part)
    keep_part(kept, parts, part, rays * parts.units(part) / which.size());
  return rays;
}

/// Averages the texels of a part by the processor. Returns the number of rays.
uint64_t average_part(Averaging& averaging, const DirectScene& lit, size_t number) {
  const size_t begin = number * kSupersampleGrain;
  PointBuffers work;
  uint64_t traced = 0;
  for (size_t k = begin; k < begin + averaging.texels_of(number).size(); ++k) {
    work.receivers.clear();
    traced += averaging.begin(k, work);
    if (work.receivers.empty()) continue;
    light_receivers(lit, averaging.asked(), work);
    traced += work.batch.rays.size() + averaging.end(k, work);
  }
  return traced;
}

/// Averages by the processor, whose parts are kept and shared out. Returns the number of rays.
/// Errors: cancelled, another member of the team gives up.
Result<uint64_t> average_in_parts(Averaging& averaging, Progress& progress) {
  const TexelScene& in = averaging.in;
  const DirectScene lit{in.scene, in.lights, in.tracer};
  PartWork parts = parts_of(averaging);
  parts.compute = [&](size_t part) { return average_part(averaging, lit, part); };
  const KeptStage kept = kept_stage(averaging.params, averaging.which, averaging.direct);
  return for_each_part({progress, kept, averaging.params.direct.team}, parts);
}

}  // namespace

Result<Supersampled> average_texels(const TexelScene& in, std::span<const uint32_t> which,
                                    const SupersampleParams& params, DirectLight& direct,
                                    Progress& progress) {
  LUXEL_CHECK(params.points >= 1);
  const atlas::Cover cover = atlas::cover_of(in.atlas, in.map, which);
  Averaging averaging{in,
                      params,
                      which,
                      cover,
                      point_scene(in),
                      direct,
                      std::vector<uint8_t>(which.size()),
                      std::vector<uint8_t>(which.size())};
  progress.begin("supersample", which.size());
  const bool on_device = in.light_device && params.direct.layers == nullptr;
  LUXEL_TRY(const uint64_t rays, on_device ? average_on_device(averaging, progress)
                                           : average_in_parts(averaging, progress));
  Supersampled out{{}, rays};
  for (size_t k = 0; k < which.size(); ++k)
    if (averaging.is_averaged[k]) out.texels.push_back(which[k]);
  return out;
}

}  // namespace luxel::light
