#include "luxel/viewfactor/sampled_factors.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/share_out.h"
#include "luxel/base/warp.h"
#include "luxel/viewfactor/surface_sampler.h"

namespace luxel::viewfactor {
namespace {

constexpr size_t kRaysPerBlock = 4096;

/// The surface whose front a ray met; kNone for a back, a surface without area, or nothing.
uint32_t surface_met(const Surfaces& surfaces, const trace::Hit& hit) {
  return hit.found() && !hit.back_face ? surfaces.of_instance[hit.instance] : scene::kNone;
}

/// The surface that each of `count` rays meets; `ray_at(k)` makes them.
template <class RayAt>
std::vector<uint32_t> surfaces_met(const Surfaces& surfaces, const trace::RayTracer& tracer,
                                   size_t count, const RayAt& ray_at, Progress& progress) {
  std::vector<uint32_t> met(count, scene::kNone);
  parallel_for(count, kRaysPerBlock, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    std::vector<trace::Ray> rays;
    for (size_t k = begin; k < end; ++k) rays.push_back(ray_at(k));
    std::vector<trace::Hit> hits(rays.size());
    tracer.closest_hits(rays, hits);
    for (size_t k = begin; k < end; ++k) met[k] = surface_met(surfaces, hits[k - begin]);
    progress.advance(end - begin);
  });
  return met;
}

trace::Ray cosine_ray(Vec3 origin, Vec3 normal, Vec2 u) {
  return {origin, 0, frame_around(normal).to_world(cosine_hemisphere_sample(u)), INFINITY};
}

/// Shares of the rays, with a bound on their standard error.
void count_shares(const std::vector<uint32_t>& met, std::span<double> factor,
                  std::span<double> error) {
  for (const uint32_t j : met)
    if (j != scene::kNone) factor[j] += 1;
  const double count = double(met.size());
  for (size_t j = 0; j < factor.size(); ++j) {
    factor[j] /= count;
    error[j] = standard_error_of_share(factor[j], count);
  }
}

/// One row of the matrix at work.
struct Row {
  const Surfaces& surfaces;
  const trace::RayTracer& tracer;
  SurfaceSampler sampler;
  uint64_t seed = 0;
  uint32_t samples = 0;

  SurfaceSample sample(const FourNumbers& numbers) const {
    return sample_surface(sampler, numbers.first);
  }
};

void row_by_rays(const Row& row, std::span<double> factor, std::span<double> error,
                 Progress& progress) {
  const auto ray_at = [&](size_t k) {
    const FourNumbers numbers = stratified_4d(uint32_t(k), row.seed);
    const SurfaceSample at = row.sample(numbers);
    return cosine_ray(at.position, at.normal, numbers.second);
  };
  count_shares(surfaces_met(row.surfaces, row.tracer, row.samples, ray_at, progress), factor,
               error);
}

/// Points whose factors are held at a time; more would need no less time.
constexpr size_t kPointsPerBatch = 64;

/// Mean and spread of values that come one after another. [Welford62]
struct Spread {
  double mean = 0, squares = 0;
  void add(double value, double count) {
    const double off = value - mean;
    mean += off / count;
    squares += off * (value - mean);
  }
};

void row_by_hemicubes(const Row& row, const Hemicube& cube, std::span<double> factor,
                      std::span<double> error, Progress& progress) {
  const size_t width = factor.size();
  std::vector<Spread> spread(width);
  std::vector<double> per_point;
  for (size_t first = 0; first < row.samples && !progress.cancelled(); first += kPointsPerBatch) {
    const size_t points = std::min<size_t>(kPointsPerBatch, row.samples - first);
    per_point.assign(points * width, 0.0);
    parallel_for(points, 1, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end && !progress.cancelled(); ++k) {
        const FourNumbers numbers = stratified_4d(uint32_t(first + k), row.seed);
        const SurfaceSample at = row.sample(numbers);
        add_hemicube_factors(row.surfaces, row.tracer, cube, {at.position, 0, at.normal, INFINITY},
                             2 * kPi * numbers.second.x, {&per_point[k * width], width}, progress);
      }
    });
    // In the order of the points, so that the bits do not depend on the threads.
    for (size_t k = 0; k < points; ++k)
      for (size_t j = 0; j < width; ++j)
        spread[j].add(per_point[k * width + j], double(first + k + 1));
  }
  const double count = double(row.samples), pixels = double(cube.direction.size());
  for (size_t j = 0; j < width; ++j) {
    factor[j] = std::clamp(spread[j].mean, 0.0, 1.0);  // rounding may reach beyond
    error[j] = row.samples == 1 ? standard_error_of_share(factor[j], 1)
                                : std::max(std::sqrt(spread[j].squares / (count * (count - 1))),
                                           standard_error_of_share(factor[j], count * pixels));
  }
}

}  // namespace

double standard_error_of_share(double share, double count) {
  const double p = (share * count + 2) / (count + 4);
  return std::sqrt(p * (1 - p) / (count + 4));
}

uint64_t sampled_factor_bytes(size_t surfaces, const SampledParams& params) {
  if (params.hemicube <= 0) return uint64_t(params.samples) * sizeof(uint32_t);
  const uint64_t pixels = 3 * uint64_t(params.hemicube) * uint64_t(params.hemicube);
  const uint64_t points = std::min<uint64_t>(kPointsPerBatch, params.samples);
  return pixels * (sizeof(Vec3) + sizeof(double)) +
         surfaces * (points * sizeof(double) + sizeof(Spread));
}

void add_hemicube_factors(const Surfaces& surfaces, const trace::RayTracer& tracer,
                          const Hemicube& cube, const trace::Ray& normal_ray, float turn_rad,
                          std::span<double> sums, Progress& progress) {
  const Frame frame = frame_around(normal_ray.direction);
  const float c = std::cos(turn_rad), s = std::sin(turn_rad);
  const Frame turned{frame.tangent * c + frame.bitangent * s,
                     frame.bitangent * c - frame.tangent * s, frame.normal};
  std::vector<trace::Ray> rays;
  std::vector<trace::Hit> hits;
  for (size_t first = 0; first < cube.direction.size() && !progress.cancelled();
       first += kRaysPerBlock) {
    const size_t end = std::min(cube.direction.size(), first + kRaysPerBlock);
    rays.clear();
    for (size_t k = first; k < end; ++k)
      rays.push_back({normal_ray.origin, 0, turned.to_world(cube.direction[k]), INFINITY});
    hits.resize(rays.size());
    tracer.closest_hits(rays, hits);
    for (size_t k = first; k < end; ++k)
      if (const uint32_t j = surface_met(surfaces, hits[k - first]); j != scene::kNone)
        sums[j] += cube.delta_factor[k];
    progress.advance(end - first);
  }
}

Result<FactorMatrix> sampled_factors(const scene::Scene& scene, const Surfaces& surfaces,
                                     const trace::RayTracer& tracer, const SampledParams& params,
                                     const FactorSelection& selection, Progress& progress,
                                     Team* team) {
  LUXEL_CHECK(params.samples >= 1 && params.samples <= (1u << 24));
  const bool by_hemicube = params.hemicube > 0;
  Hemicube cube;
  if (by_hemicube) {
    LUXEL_TRY(cube, make_hemicube(params.hemicube, progress));
  }
  FactorMatrix matrix = empty_factor_matrix(surfaces);
  const size_t width = matrix.size();
  const size_t rows = selection.from == scene::kNone ? width : 1;
  const size_t rays_per_sample = by_hemicube ? cube.direction.size() : 1;
  progress.begin("trace rays", uint64_t(rows) * params.samples * rays_per_sample);
  const auto factor_of = [&](size_t i) {
    return std::span(matrix.factor).subspan(i * width, width);
  };
  const auto error_of = [&](size_t i) { return std::span(matrix.error).subspan(i * width, width); };
  const auto look_from = [&](size_t piece) {
    const uint32_t i = selection.from == scene::kNone ? uint32_t(piece) : selection.from;
    const Row row{surfaces, tracer, make_surface_sampler(scene, surfaces.surfaces[i].instance),
                  hash64(params.seed, i), params.samples};
    if (by_hemicube)
      row_by_hemicubes(row, cube, factor_of(i), error_of(i), progress);
    else
      row_by_rays(row, factor_of(i), error_of(i), progress);
  };
  // A single row is everybody's.
  Team* const sharing = rows > 1 ? team : nullptr;
  LUXEL_TRY(const std::vector<uint32_t> own, share_out_in_turn(sharing, rows, progress, look_from));
  LUXEL_TRY_STATUS(exchange(sharing, own,
                            {rows,
                             [&](size_t i, ByteWriter& out) {
                               out.put(std::span<const double>(factor_of(i)));
                               out.put(std::span<const double>(error_of(i)));
                             },
                             [&](size_t i, uint32_t, ByteReader& in) {
                               in.get(factor_of(i)), in.get(error_of(i));
                               return in.ok;
                             }},
                            progress));
  return matrix;
}

}  // namespace luxel::viewfactor
