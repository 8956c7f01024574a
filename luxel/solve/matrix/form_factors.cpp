#include "luxel/solve/matrix/form_factors.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/share_out.h"
#include "luxel/base/warp.h"

namespace luxel::matrix {
namespace {

/// Directions are sorted into 8 x 8 cells, so that rays of a packet go the same way.
constexpr int kCellsPerAxis = 8;

/// Buffers of a thread to look from one patch.
struct RayBuffers {
  explicit RayBuffers(size_t rays) : u(rays), v(rays), ray(rays), hit(rays) {}
  std::vector<float> u, v;
  std::vector<trace::Ray> ray;
  std::vector<trace::Hit> hit;
  std::vector<uint32_t> met;
};

/// Rays from a patch's points in turn, in the order of their directions, so that neighbours are
/// alike: each of the points takes its share of every direction.
void fill_rays(std::span<const PatchPoint> points, uint64_t seed, RayBuffers& buffers) {
  const size_t count = buffers.ray.size();
  sobol_owen_2d_points(seed, buffers.u, buffers.v);
  const auto cell = [&](size_t i) {
    const int a = int(buffers.u[i] * kCellsPerAxis), b = int(buffers.v[i] * kCellsPerAxis);
    return size_t(b * kCellsPerAxis + (b % 2 ? kCellsPerAxis - 1 - a : a));
  };
  std::array<uint32_t, kCellsPerAxis * kCellsPerAxis + 1> place{};
  for (size_t i = 0; i < count; ++i) ++place[cell(i) + 1];
  for (size_t c = 0; c + 1 < place.size(); ++c) place[c + 1] += place[c];
  for (size_t i = 0; i < count; ++i) {
    const PatchPoint& p = points[i % points.size()];
    const Vec3 d =
        frame_around(p.normal).to_world(cosine_hemisphere_sample({buffers.u[i], buffers.v[i]}));
    buffers.ray[place[cell(i)]++] = {p.position, 0, d, INFINITY};
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

void put_row(const Row& row, float sky, ByteWriter& out) {
  out.put_value(sky), out.put_value(uint32_t(row.column.size()));
  out.put(std::span(row.column)), out.put(std::span(row.factor));
}

void get_row(ByteReader& in, Row& row, float& sky) {
  sky = in.get_value<float>();
  const uint32_t count = in.get_value<uint32_t>();
  in.ok = in.ok && count <= in.bytes.size() / (sizeof(uint32_t) + sizeof(float));
  if (!in.ok) return;
  row.column.resize(count), row.factor.resize(count);
  in.get(std::span(row.column)), in.get(std::span(row.factor));
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
  // (A F)^T: rows are counted, then filled in the order of their columns.
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
  // Rows of both, merged by column.
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

/// Root mean square of what rows may miss, over what they should be. The noise of rays is 1e-2.
constexpr double kBalanced = 1e-5;
constexpr int kNewtonSteps = 2, kInnerSteps = 60, kPasses = 20;
/// The inner iteration solves to a tenth of what Newton's step is to reach: what it leaves then
/// does not count beside what is not linear.
constexpr double kInnerPart = 0.1;
/// A step of Newton's method changes no factor by more than e^0.5 = 1.65. log d is linear nearby
/// only, and rows that hardly any ray found would ask for far more.
constexpr double kLargestStep = 0.5;
/// Two sides that only see each other must add up to the same, which rays do not quite find: the
/// system is singular then. This much of the diagonal on top of it leaves that mode alone.
constexpr double kRidge = 1e-3;
/// No factor beyond this and its inverse: what needs one is no noise of rays.
constexpr double kLargestFactor = 2;

/// out_i = d_i sum_j S_ij d_j x_j
void scaled_product(const FormFactors& s, std::span<const double> d, std::span<const double> x,
                    std::span<double> out) {
  parallel_for(s.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      double sum = 0;
      for (uint64_t k = s.first[i]; k < s.first[i + 1]; ++k)
        sum += double(s.factor[k]) * d[s.column[k]] * x[s.column[k]];
      out[i] = d[i] * sum;
    }
  });
}

double dot_product(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Solves ((1 + kRidge) diag(row) + D S D) x = b by conjugate gradients, as far as `enough`.
std::vector<double> newton_step(const FormFactors& s, std::span<const double> d,
                                std::span<const double> row, std::vector<double> b, double enough) {
  const size_t n = b.size();
  std::vector<double> x(n), z(n), p(n), ap(n);
  const auto precondition = [&] {
    for (size_t i = 0; i < n; ++i) z[i] = row[i] > 0 ? b[i] / row[i] : 0;
  };
  precondition();
  p = z;
  double rz = dot_product(b, z);
  for (int k = 0; k < kInnerSteps && rz > 0 && std::sqrt(dot_product(b, b)) > enough; ++k) {
    scaled_product(s, d, p, ap);
    for (size_t i = 0; i < n; ++i) ap[i] += (1 + kRidge) * row[i] * p[i];
    const double alpha = rz / std::max(dot_product(p, ap), 1e-300);
    for (size_t i = 0; i < n; ++i) x[i] += alpha * p[i], b[i] -= alpha * ap[i];
    precondition();
    const double next = dot_product(b, z);
    for (size_t i = 0; i < n; ++i) p[i] = z[i] + next / rz * p[i];
    rz = next;
  }
  return x;
}

/// d with sum_j d_i S_ij d_j = wanted_i, nearly: Newton's method for log d [Knight13], then a few
/// passes of d_i *= sqrt(wanted_i / row_i) for what is far from linear. Passes alone would need
/// hundreds where light goes back and forth between two sides, as between plates.
std::vector<double> scaling(const FormFactors& s, std::span<const double> wanted) {
  const size_t n = s.size();
  const std::vector<double> one(n, 1.0);
  std::vector<double> d(n, 1.0), row(n), missing(n);
  const double enough = kBalanced * std::sqrt(dot_product(wanted, wanted));
  for (int step = 0; step < kNewtonSteps; ++step) {
    scaled_product(s, d, one, row);
    for (size_t i = 0; i < n; ++i) missing[i] = row[i] > 0 ? wanted[i] - row[i] : 0;
    if (std::sqrt(dot_product(missing, missing)) <= enough) break;
    const std::vector<double> change = newton_step(s, d, row, missing, kInnerPart * enough);
    for (size_t i = 0; i < n; ++i)
      d[i] = std::clamp(d[i] * std::exp(std::clamp(change[i], -kLargestStep, kLargestStep)),
                        1 / kLargestFactor, kLargestFactor);
  }
  for (int pass = 0; pass < kPasses; ++pass) {
    scaled_product(s, d, one, row);
    for (size_t i = 0; i < n; ++i)
      if (row[i] > 0 && wanted[i] > 0)
        d[i] = std::clamp(d[i] * std::sqrt(wanted[i] / row[i]), 1 / kLargestFactor, kLargestFactor);
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
                                    const PatchedScene& patched, const FactorParams& params,
                                    Progress& progress, Team* team) {
  LUXEL_CHECK(params.rays_per_patch >= 1);
  const Patches& patches = patched.patches;
  const size_t rays = size_t(params.rays_per_patch);
  TracedFactors out;
  out.sky.resize(patches.size());
  std::vector<Row> rows(patches.size());
  progress.begin("form factors", patches.size());
  constexpr size_t kPatchesPerPiece = 16;
  const size_t pieces = (patches.size() + kPatchesPerPiece - 1) / kPatchesPerPiece;
  const auto end_of = [&](size_t piece) {
    return std::min((piece + 1) * kPatchesPerPiece, patches.size());
  };
  const auto look = [&](size_t piece) {
    const size_t begin = piece * kPatchesPerPiece, end = end_of(piece);
    RayBuffers buffers(rays);
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      // Rays from the points of the patch, and the patches that they meet.
      fill_rays(patches.points_of(i), hash64(params.seed, i), buffers);
      tracer.closest_hits(buffers.ray, buffers.hit);
      buffers.met.clear();
      size_t escaped = 0;
      for (const trace::Hit& hit : buffers.hit) {
        if (!hit.found()) {
          ++escaped;
          continue;
        }
        const uint32_t j = patch_met(patched, scene, tracer, hit);
        if (j != kNone) buffers.met.push_back(j);
      }
      // Shares of the rays.
      rows[i] = row_of(buffers.met, rays);
      out.sky[i] = float(escaped) / float(rays);
      progress.advance(1);
    }
  };
  LUXEL_TRY(const std::vector<uint32_t> own, share_out(team, pieces, progress, look));
  LUXEL_TRY_STATUS(exchange(team, own,
                            {pieces,
                             [&](size_t piece, ByteWriter& bytes) {
                               for (size_t i = piece * kPatchesPerPiece; i < end_of(piece); ++i)
                                 put_row(rows[i], out.sky[i], bytes);
                             },
                             [&](size_t piece, uint32_t, ByteReader& bytes) {
                               for (size_t i = piece * kPatchesPerPiece; i < end_of(piece); ++i)
                                 get_row(bytes, rows[i], out.sky[i]);
                               return bytes.ok;
                             }},
                            progress));
  out.factors = joined(rows);
  out.rays = uint64_t(rays) * patches.size();
  return out;
}

FormFactors reciprocal(const FormFactors& traced, std::span<const float> area_m2) {
  // Exchange areas S, and what their rows should sum to.
  FormFactors s = symmetric(traced, area_m2);
  std::vector<double> wanted(traced.size());
  for (size_t i = 0; i < wanted.size(); ++i)
    wanted[i] = std::min(1.0, row_sum(traced, i)) * double(area_m2[i]);
  // S scaled to that, and how far rows still exceed 1.
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
  // Back to F = S / A, with no row beyond 1 and still reciprocal.
  parallel_for(s.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (uint64_t k = s.first[i]; k < s.first[i + 1]; ++k)
        s.factor[k] *= std::min(limit[i], limit[s.column[k]]) / area_m2[i];
  });
  return s;
}

void multiply(const FormFactors& factors, std::span<const Rgb> radiosity,
              std::span<Rgb> irradiance) {
  LUXEL_CHECK(radiosity.size() == factors.size() && irradiance.size() == factors.size());
  parallel_for(factors.size(), 64, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Rgb sum{};
      for (uint64_t k = factors.first[i]; k < factors.first[i + 1]; ++k)
        sum += factors.factor[k] * radiosity[factors.column[k]];
      irradiance[i] = sum;
    }
  });
}

}  // namespace luxel::matrix
