#include "solve/matrix/form_factors.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/warp.h"

namespace luxel::matrix {
namespace {

constexpr int kCellsPerAxis = 8;

/// What a thread needs to look from one patch.
struct Work {
  explicit Work(size_t rays) : u(rays), v(rays), ray(rays), hit(rays) {}
  std::vector<float> u, v;
  std::vector<trace::Ray> ray;
  std::vector<trace::Hit> hit;
  std::vector<uint32_t> met;
};

/// Rays from a patch's points in turn, in the order of their directions, so that neighbours are
/// alike: each of the points takes its share of every direction.
void fill_rays(std::span<const PatchPoint> points, uint64_t seed, float diagonal_m, Work& work) {
  const size_t count = work.ray.size();
  sobol_owen_2d_points(seed, work.u, work.v);
  const auto cell = [&](size_t i) {
    const int a = int(work.u[i] * kCellsPerAxis), b = int(work.v[i] * kCellsPerAxis);
    return size_t(b * kCellsPerAxis + (b % 2 ? kCellsPerAxis - 1 - a : a));
  };
  std::array<uint32_t, kCellsPerAxis * kCellsPerAxis + 1> place{};
  for (size_t i = 0; i < count; ++i) ++place[cell(i) + 1];
  for (size_t c = 0; c + 1 < place.size(); ++c) place[c + 1] += place[c];
  for (size_t i = 0; i < count; ++i) {
    const PatchPoint& p = points[i % points.size()];
    const Vec3 d =
        frame_around(p.normal).to_world(cosine_hemisphere_sample({work.u[i], work.v[i]}));
    work.ray[place[cell(i)]++] = {trace::offset_origin(p.position, p.normal, diagonal_m), 0, d,
                                  INFINITY};
  }
}

struct Row {
  std::vector<uint32_t> column;
  std::vector<float> factor;
};

/// The patches that rays met, and how often.
Row row_of(std::vector<uint32_t>& met, size_t rays) {
  std::sort(met.begin(), met.end());
  Row row;
  for (size_t k = 0; k < met.size();) {
    size_t end = k;
    while (end < met.size() && met[end] == met[k]) ++end;
    row.column.push_back(met[k]), row.factor.push_back(float(end - k) / float(rays));
    k = end;
  }
  return row;
}

FormFactors joined(std::vector<Row>& rows) {
  FormFactors out;
  out.first.push_back(0);
  for (const Row& row : rows) out.first.push_back(out.first.back() + row.column.size());
  out.column.reserve(out.first.back()), out.factor.reserve(out.first.back());
  for (Row& row : rows) {
    out.column.insert(out.column.end(), row.column.begin(), row.column.end());
    out.factor.insert(out.factor.end(), row.factor.begin(), row.factor.end());
    row = {};
  }
  return out;
}

/// S = (A F + (A F)^T) / 2. Both have ascending columns, so rows merge.
FormFactors symmetric(const FormFactors& traced, std::span<const float> area_m2) {
  const size_t n = traced.size();
  FormFactors transposed;
  transposed.first.assign(n + 1, 0);
  for (const uint32_t j : traced.column) ++transposed.first[j + 1];
  for (size_t j = 0; j < n; ++j) transposed.first[j + 1] += transposed.first[j];
  transposed.column.resize(traced.column.size()), transposed.factor.resize(traced.column.size());
  std::vector<uint64_t> place(transposed.first.begin(), transposed.first.end() - 1);
  for (uint32_t i = 0; i < n; ++i)
    for (uint64_t k = traced.first[i]; k < traced.first[i + 1]; ++k) {
      const uint64_t at = place[traced.column[k]]++;
      transposed.column[at] = i;
      transposed.factor[at] = traced.factor[k] * area_m2[i];
    }
  FormFactors out;
  out.first.push_back(0);
  out.column.reserve(2 * traced.column.size()), out.factor.reserve(2 * traced.column.size());
  for (size_t i = 0; i < n; ++i) {
    uint64_t a = traced.first[i], b = transposed.first[i];
    while (a < traced.first[i + 1] || b < transposed.first[i + 1]) {
      const uint32_t ca = a < traced.first[i + 1] ? traced.column[a] : kNone;
      const uint32_t cb = b < transposed.first[i + 1] ? transposed.column[b] : kNone;
      float s = 0;
      if (ca <= cb) s += traced.factor[a++] * area_m2[i];
      if (cb <= ca) s += transposed.factor[b++];
      out.column.push_back(std::min(ca, cb)), out.factor.push_back(s / 2);
    }
    out.first.push_back(out.column.size());
  }
  return out;
}

constexpr int kScalingPasses = 20;

/// d with sum_j d_i S_ij d_j = wanted_i, nearly.
std::vector<double> scaling(const FormFactors& s, std::span<const double> wanted) {
  std::vector<double> d(s.size(), 1.0), next(s.size());
  for (int pass = 0; pass < kScalingPasses; ++pass) {
    parallel_for(s.size(), 256, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        double sum = 0;
        for (uint64_t k = s.first[i]; k < s.first[i + 1]; ++k)
          sum += double(s.factor[k]) * d[s.column[k]];
        // Half way, geometrically, because d stands on both sides. What can only be had by a large
        // factor is no noise of rays.
        next[i] = sum > 0 && wanted[i] > 0 ? std::clamp(std::sqrt(d[i] * wanted[i] / sum), 0.5, 2.0)
                                           : 1.0;
      }
    });
    d.swap(next);
  }
  return d;
}

}  // namespace

double row_sum(const FormFactors& factors, size_t row) {
  double sum = 0;
  for (const float f : factors.factors_of(row)) sum += double(f);
  return sum;
}

Result<TracedFactors> trace_factors(const scene::Scene& scene, const trace::RayTracer& tracer,
                                    const PatchWork& work, const FactorParams& params,
                                    Progress& progress) {
  LUXEL_CHECK(params.rays_per_patch >= 1);
  const Patches& patches = work.patches;
  const size_t rays = size_t(params.rays_per_patch);
  const Box3 bounds = scene::world_bounds(scene);
  const float diagonal_m = length(bounds.upper - bounds.lower);
  TracedFactors out;
  out.sky.resize(patches.size());
  std::vector<Row> rows(patches.size());
  progress.begin("form factors", patches.size());
  parallel_for(patches.size(), 16, [&](size_t begin, size_t end) {
    Work w(rays);
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      fill_rays(patches.points_of(i), hash64(params.seed, i), diagonal_m, w);
      tracer.closest_hits(w.ray, w.hit);
      w.met.clear();
      size_t escaped = 0;
      for (const trace::Hit& hit : w.hit) {
        if (!hit.found()) {
          ++escaped;
          continue;
        }
        const scene::Mesh& mesh = scene.meshes[scene.instances[hit.instance].mesh];
        const uint32_t material = mesh.triangle_material[hit.triangle];
        if (hit.back_face && !scene.materials[material].double_sided) continue;
        const uint32_t j = work.locator.locate(
            scene::world_position(scene, hit.point()),
            scene::front_normal(scene, hit.instance, hit.triangle), material, tracer);
        if (j != kNone) w.met.push_back(j);
      }
      rows[i] = row_of(w.met, rays);
      out.sky[i] = float(escaped) / float(rays);
      progress.advance(1);
    }
  });
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "cancelled");
  out.factors = joined(rows);
  out.rays = uint64_t(rays) * patches.size();
  return out;
}

FormFactors reciprocal(const FormFactors& traced, std::span<const float> area_m2) {
  FormFactors s = symmetric(traced, area_m2);
  std::vector<double> wanted(traced.size());
  for (size_t i = 0; i < wanted.size(); ++i)
    wanted[i] = std::min(1.0, row_sum(traced, i)) * double(area_m2[i]);
  const std::vector<double> d = scaling(s, wanted);
  std::vector<float> limit(s.size());
  parallel_for(s.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      double sum = 0;
      for (uint64_t k = s.first[i]; k < s.first[i + 1]; ++k) {
        s.factor[k] = float(double(s.factor[k]) * d[i] * d[s.column[k]]);
        sum += double(s.factor[k]);
      }
      const double share = sum / double(area_m2[i]);
      limit[i] = share > 1 ? float(1 / share) : 1.0f;
    }
  });
  parallel_for(s.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (uint64_t k = s.first[i]; k < s.first[i + 1]; ++k)
        s.factor[k] *= std::min(limit[i], limit[s.column[k]]) / area_m2[i];
  });
  return s;
}

}  // namespace luxel::matrix
