#include "transport/supersample.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "transport/backs_seen.h"
#include "transport/direct_shots.h"

namespace luxel::transport {
namespace {

constexpr size_t kGrain = 16;
/// For one of many points, and for the sample of a texel, as gather asks.
constexpr int kEnclosureRays = 16, kEnclosureRaysOfTexel = 64;
constexpr uint64_t kPointSeed = 0x70e1;

/// What all points share.
struct Place {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  float diagonal_m;
};

/// Whether a point lies inside a solid; of each place the same answer in every bake.
bool is_enclosed(const Place& at, const Receiver& r, int rays = kEnclosureRays) {
  return is_enclosed(backs_seen(at.scene, at.tracer, r.origin, r.normal, rays));
}

Receiver receiver_at(const Place& at, const SmoothPoint& s, uint64_t seed) {
  return {s.position, s.normal, s.geometric_normal,
          trace::offset_origin(s.position, s.geometric_normal, at.diagonal_m), seed};
}

/// Only to be asked whether it is enclosed: it has no seed.
Receiver own_receiver(const Place& at, const Elements& elements, size_t i) {
  return receiver_at(at, {elements.position[i], elements.normal[i], elements.geometric_normal[i]},
                     0);
}

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

bool differ(const DirectLight& direct, size_t a, size_t b, float threshold) {
  const Rgb p = direct.irradiance[a], q = direct.irradiance[b];
  const float difference = max_component(max(p - q, q - p));
  const float noise = std::sqrt(direct.variance[a] + direct.variance[b]);
  return difference > threshold * max_component(max(p, q)) && difference > 3 * noise;
}

bool is_dark(Rgb light) { return max_component(light) <= 0; }

int samples_per_point(int samples) { return std::max(std::min(samples, 8), samples / 8); }

}  // namespace

std::vector<uint32_t> uneven_texels(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                    const DirectLight& direct, float threshold) {
  const int side = map.resolution;
  std::vector<uint8_t> uneven(map.texels.size());
  const auto chart_of = [&](size_t i) { return atlas.chart[map.texels[i].triangle_number]; };
  parallel_for(map.texels.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const int x = int(map.texels[i].x), y = int(map.texels[i].y);
      for (int v = std::max(0, y - 1); v <= std::min(side - 1, y + 1) && !uneven[i]; ++v)
        for (int u = std::max(0, x - 1); u <= std::min(side - 1, x + 1) && !uneven[i]; ++u) {
          const uint32_t j = map.texel_at[size_t(v) * size_t(side) + size_t(u)];
          if (j == atlas::kNone || j == i || chart_of(i) != chart_of(j)) continue;
          uneven[i] = differ(direct, i, j, threshold);
        }
    }
  });
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < uneven.size(); ++i)
    if (uneven[i]) out.push_back(i);
  return out;
}

Result<Footprints> footprints(const scene::Scene& scene, const atlas::Atlas& atlas,
                              const atlas::TexelMap& map, const Elements& elements,
                              const trace::RayTracer& tracer, int points, uint64_t seed,
                              Progress& progress) {
  LUXEL_CHECK(points >= 1);
  std::vector<uint32_t> all(map.texels.size());
  std::iota(all.begin(), all.end(), 0u);
  const atlas::Cover cover = atlas::cover_of(atlas, map, all);
  const Place place{scene, tracer, scene::world_bounds(scene).diagonal()};
  std::vector<std::vector<Receiver>> found(all.size());
  progress.begin("footprints", all.size());
  parallel_for(all.size(), kGrain, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    std::vector<scene::SurfacePoint> spread;
    for (size_t i = begin; i < end; ++i) {
      const Receiver own = own_receiver(place, elements, i);
      if (!is_enclosed(place, own, kEnclosureRaysOfTexel)) {
        atlas::spread_points(atlas, map.texels[i], cover.of(i), points, seed, spread);
        for (const scene::SurfacePoint& p : spread) {
          const Receiver r = receiver_at(place, smooth_point(scene, p), 0);
          if (!is_enclosed(place, r)) found[i].push_back(r);
        }
      }
      if (found[i].empty()) found[i].push_back(own);
    }
    progress.advance(end - begin);
  });
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped by the user");
  Footprints out;
  out.first.push_back(0);
  for (size_t i = 0; i < all.size(); ++i) {
    for (const Receiver& r : found[i]) {
      out.points.position.push_back(r.position), out.points.normal.push_back(r.normal);
      out.points.geometric_normal.push_back(r.geometric_normal);
    }
    out.first.push_back(uint32_t(out.points.size()));
    found[i] = {};
  }
  return out;
}

Result<Supersampled> supersample(const scene::Scene& scene, const atlas::Atlas& atlas,
                                 const atlas::TexelMap& map, const Elements& elements,
                                 const Lights& lights, const trace::RayTracer& tracer,
                                 const SupersampleParams& params, DirectLight& direct,
                                 Progress& progress) {
  if (params.points == 1) return Supersampled{};
  return average_texels(scene, atlas, map, elements, lights, tracer,
                        uneven_texels(atlas, map, direct, params.threshold), params, direct,
                        progress);
}

Result<Supersampled> average_texels(const scene::Scene& scene, const atlas::Atlas& atlas,
                                    const atlas::TexelMap& map, const Elements& elements,
                                    const Lights& lights, const trace::RayTracer& tracer,
                                    std::span<const uint32_t> which,
                                    const SupersampleParams& params, DirectLight& direct,
                                    Progress& progress) {
  LUXEL_CHECK(params.points >= 1);
  const atlas::Cover cover = atlas::cover_of(atlas, map, which);
  const Place place{scene, tracer, scene::world_bounds(scene).diagonal()};
  DirectParams each = params.direct;
  each.samples = samples_per_point(params.direct.samples);
  std::atomic<uint64_t> rays{0};
  std::vector<uint8_t> is_averaged(which.size());
  progress.begin("supersample", which.size());
  parallel_for(which.size(), kGrain, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    Shots shots;
    std::vector<scene::SurfacePoint> spread;
    std::vector<Receiver> receivers;
    std::vector<LightAt> light;
    std::vector<PointLight> points;
    std::vector<Rgb> by_layer(each.layers ? each.layers->size() : 0);
    uint64_t traced = 0;
    for (size_t k = begin; k < end; ++k) {
      const uint32_t i = which[k];
      if (is_dark(direct.irradiance[i])) {
        traced += uint64_t(kEnclosureRaysOfTexel);
        const Receiver own = own_receiver(place, elements, i);
        if (is_enclosed(place, own, kEnclosureRaysOfTexel)) continue;
      }
      receivers.clear(), points.clear();
      std::ranges::fill(by_layer, Rgb{});
      atlas::spread_points(atlas, map.texels[i], cover.of(k), params.points, each.seed, spread);
      for (const scene::SurfacePoint& p : spread) {
        const uint64_t seed = hash64(hash64(each.seed, kPointSeed + receivers.size()), i);
        receivers.push_back(receiver_at(place, smooth_point(scene, p), seed));
      }
      light.resize(receivers.size());
      direct_light_at(scene, lights, tracer, each, receivers, place.diagonal_m, shots, light);
      traced += shots.rays.size();
      for (size_t j = 0; j < receivers.size(); ++j) {
        // Where a wall stands on the surface, its inside is dark, and nobody sees it.
        const bool dark = is_dark(light[j].irradiance);
        traced += dark ? uint64_t(kEnclosureRays) : 0;
        if (dark && is_enclosed(place, receivers[j])) continue;
        points.push_back({receivers[j].position, light[j].irradiance, light[j].variance});
        if (each.layers) add_light_by_layer(shots, j, *each.layers, {1, 1, 1}, by_layer);
      }
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
    progress.advance(end - begin);
  });
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped by the user");
  Supersampled out{{}, rays};
  for (size_t k = 0; k < which.size(); ++k)
    if (is_averaged[k]) out.texels.push_back(which[k]);
  return out;
}

}  // namespace luxel::transport
