#include "luxel/light/light_around.h"

#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/light/direct_light.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::light {
namespace {

/// Elements whose direct light is taken at a time: what they need stays below 100 MB.
constexpr size_t kMostElements = 1 << 19;

/// Rays and the radiance that they bring, without direct light of punctual lights: reflected light
/// and the soft sky.
struct Arrivals {
  std::vector<trace::Ray> rays;
  std::vector<trace::Hit> hits;
  std::vector<Rgb> radiance;
  size_t surfaces = 0, backs = 0;
};

void look_around(const LitScene& lit, Arrivals& a) {
  a.hits.resize(a.rays.size());
  lit.tracer.closest_hits(a.rays, a.hits);
  a.radiance.assign(a.rays.size(), {1, 1, 1});
  if (lit.tracer.has_tints()) lit.tracer.tint(a.rays, a.hits, a.radiance);
  a.surfaces = a.backs = 0;
  for (size_t k = 0; k < a.rays.size(); ++k) {
    const trace::Hit& hit = a.hits[k];
    if (!hit.found()) {
      a.radiance[k] =
          a.radiance[k] * soft_radiance(lit.scene, lit.lights.around, a.rays[k].direction);
      continue;
    }
    ++a.surfaces;
    a.backs += hit.back_face;
    const scene::SurfacePoint p = hit.point();
    if (hit.back_face && !scene::reflects_from_behind(scene::material_at(lit.scene, p)))
      a.radiance[k] = {};
    else
      a.radiance[k] =
          a.radiance[k] * transport::radiosity_at(lit.scene, p, lit.irradiance_at) * (1 / kPi);
  }
}

/// Least squares of E over the spiral's directions: solves (Y^T Y) c = Y^T E. Y^T Y is nearly
/// diagonal, so that a few sweeps of Gauss and Seidel are exact to rounding.
std::array<Rgb, kSh2> fit(std::span<const Rgb> irradiance) {
  std::array<std::array<double, kSh2>, kSh2> a{};
  std::array<std::array<double, 3>, kSh2> b{}, c{};
  for (uint32_t i = 0; i < kProbeNormals; ++i) {
    const auto y = sh2_basis(spiral_direction(i, kProbeNormals));
    for (size_t k = 0; k < kSh2; ++k) {
      for (size_t l = 0; l < kSh2; ++l) a[k][l] += double(y[k]) * double(y[l]);
      b[k][0] += double(y[k]) * double(irradiance[i].x);
      b[k][1] += double(y[k]) * double(irradiance[i].y);
      b[k][2] += double(y[k]) * double(irradiance[i].z);
    }
  }
  for (int sweep = 0; sweep < 30; ++sweep)
    for (size_t k = 0; k < kSh2; ++k)
      for (size_t channel = 0; channel < 3; ++channel) {
        double rest = b[k][channel];
        for (size_t l = 0; l < kSh2; ++l)
          if (l != k) rest -= a[k][l] * c[l][channel];
        c[k][channel] = rest / a[k][k];
      }
  std::array<Rgb, kSh2> out;
  for (size_t k = 0; k < kSh2; ++k) out[k] = {float(c[k][0]), float(c[k][1]), float(c[k][2])};
  return out;
}

/// The cosine lobe's factor in each function's band. [Ramamoorthi01, eq. 8]
float band_factor(size_t k) { return k == 0 ? kPi : k < 4 ? 2 * kPi / 3 : kPi / 4; }

/// Direct light for `per_point` normals of every point, which `add` appends to the elements; `take`
/// gets it. Returns the number of rays.
template <class Add, class Take>
Result<uint64_t> direct_by_normals(const LitScene& lit, size_t points, size_t per_point,
                                   const AroundParams& params, const Add& add, const Take& take,
                                   Progress& progress) {
  uint64_t rays = 0;
  const size_t at_once = std::max<size_t>(1, kMostElements / per_point);
  for (size_t first = 0; first < points; first += at_once) {
    const size_t last = std::min(points, first + at_once);
    transport::Elements elements;
    for (size_t i = first; i < last; ++i) add(i, elements);
    LUXEL_TRY(const DirectLight direct,
              direct_light(lit.scene, elements, lit.lights, lit.tracer,
                           {params.direct_samples, hash64(params.seed, first)}, progress));
    for (size_t i = first; i < last; ++i)
      take(i, std::span(direct.irradiance).subspan((i - first) * per_point, per_point));
    rays += direct.rays;
  }
  return rays;
}

void add_element(transport::Elements& e, Vec3 position, Vec3 normal, Vec3 geometric_normal) {
  e.position.push_back(position), e.normal.push_back(normal);
  e.geometric_normal.push_back(geometric_normal), e.reflectance.push_back({});
}

}  // namespace

Result<Probes> light_probes(const LitScene& lit, std::span<const Vec3> positions,
                            const AroundParams& params, Progress& progress) {
  Probes result{std::vector<Probe>(positions.size()), positions.size() * uint64_t(params.samples)};
  std::vector<Probe>& out = result.probes;
  progress.begin("probes", positions.size());
  parallel_for(positions.size(), 16, [&](size_t begin, size_t end) {
    Arrivals a;
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      out[i].position = positions[i];
      a.rays.clear();
      for (uint32_t k = 0; k < uint32_t(params.samples); ++k)
        a.rays.push_back({positions[i], 0,
                          uniform_sphere_sample(sobol_owen_2d(k, hash64(params.seed, i))),
                          INFINITY});
      look_around(lit, a);
      out[i].backs = a.surfaces > 0 ? float(a.backs) / float(a.surfaces) : 0.0f;
      for (size_t k = 0; k < a.rays.size(); ++k) {
        const auto y = sh2_basis(a.rays[k].direction);
        for (size_t c = 0; c < kSh2; ++c)
          out[i].irradiance[c] +=
              a.radiance[k] * (y[c] * band_factor(c) * 4 * kPi / float(params.samples));
      }
    }
    progress.advance(end - begin);
  });
  LUXEL_TRY_STATUS(stopped(progress));
  const auto add = [&](size_t i, transport::Elements& elements) {
    for (uint32_t k = 0; k < kProbeNormals; ++k) {
      const Vec3 n = spiral_direction(k, kProbeNormals);
      add_element(elements, positions[i], n, n);
    }
  };
  const auto take = [&](size_t i, std::span<const Rgb> direct) {
    const std::array<Rgb, kSh2> c = fit(direct);
    for (size_t k = 0; k < kSh2; ++k) out[i].irradiance[k] += c[k];
  };
  LUXEL_TRY(const uint64_t direct_rays,
            direct_by_normals(lit, positions.size(), kProbeNormals, params, add, take, progress));
  result.rays += direct_rays;
  return result;
}

Result<Arriving> arriving_light(const LitScene& lit, std::span<const Vec3> positions,
                                std::span<const Vec3> normals, const AroundParams& params,
                                Progress& progress) {
  const size_t n = positions.size();
  LUXEL_CHECK(normals.size() == n && params.samples >= 1);
  Arriving out{std::vector<Rgb>(n), std::vector<Rgb>(n), std::vector<float>(n),
               n * uint64_t(params.samples)};
  progress.begin("final rays", n);
  parallel_for(n, 16, [&](size_t begin, size_t end) {
    Arrivals a;
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      const Frame frame = frame_around(normals[i]);
      a.rays.clear();
      for (uint32_t k = 0; k < uint32_t(params.samples); ++k) {
        const Vec3 d = cosine_hemisphere_sample(sobol_owen_2d(k, hash64(params.seed, i)));
        a.rays.push_back({positions[i], 0, frame.to_world(d), INFINITY});
      }
      look_around(lit, a);
      // The density is cos / pi: each ray stands for pi / samples of E.
      const float share = 1 / float(params.samples);
      for (size_t k = 0; k < a.rays.size(); ++k) {
        const trace::Hit& hit = a.hits[k];
        (hit.found() ? out.reflected : out.sky)[i] += a.radiance[k] * (kPi * share);
        if (hit.found() && hit.back_face &&
            !scene::reflects_from_behind(scene::material_at(lit.scene, hit.point())))
          out.backs[i] += share;
      }
    }
    progress.advance(end - begin);
  });
  LUXEL_TRY_STATUS(stopped(progress));
  return out;
}

namespace {

/// n tilted to the four sides of its frame.
std::array<Vec3, 4> tilted(const Frame& frame, Vec3 n) {
  const float c = std::cos(kTilt), s = std::sin(kTilt);
  return {n * c + frame.tangent * s, n * c - frame.tangent * s, n * c + frame.bitangent * s,
          n * c - frame.bitangent * s};
}

/// V from E of the four and of n itself: along a tangent half the difference of opposite ones over
/// the sine; along the normal their mean less E, over cos - 1.
Bent bent_from(const Frame& frame, Vec3 n, const std::array<Rgb, 4>& e, Rgb flat) {
  const float s = std::sin(kTilt), c = std::cos(kTilt);
  const Rgb along_t = (e[0] - e[1]) / (2 * s), along_b = (e[2] - e[3]) / (2 * s);
  const Rgb along_n = ((e[0] + e[1] + e[2] + e[3]) * 0.25f - flat) / (c - 1);
  const auto part = [&](float t, float b, float up) {
    return along_t * t + along_b * b + along_n * up;
  };
  return {{part(frame.tangent.x, frame.bitangent.x, n.x),
           part(frame.tangent.y, frame.bitangent.y, n.y),
           part(frame.tangent.z, frame.bitangent.z, n.z)}};
}

}  // namespace

Result<BentLight> bent_irradiance(const LitScene& lit, std::span<const Vec3> positions,
                                  std::span<const Vec3> normals,
                                  std::span<const Vec3> geometric_normals,
                                  const AroundParams& params, Progress& progress) {
  const size_t n = positions.size();
  LUXEL_CHECK(normals.size() == n && geometric_normals.size() == n);
  /// E of the four tilted normals, and of the normal itself by the same rays: V is taken from
  /// differences, and noise that all five share does not show in them.
  std::vector<std::array<Rgb, 5>> light(n);
  progress.begin("directions", n);
  parallel_for(n, 256, [&](size_t begin, size_t end) {
    Arrivals a;
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      const Frame frame = frame_around(normals[i]), above = frame_around(geometric_normals[i]);
      a.rays.clear();
      for (uint32_t k = 0; k < uint32_t(params.samples); ++k) {
        Vec3 d = uniform_sphere_sample(sobol_owen_2d(k, hash64(params.seed, i)));
        d.z = std::abs(d.z);
        a.rays.push_back({positions[i], 0, above.to_world(d), INFINITY});
      }
      look_around(lit, a);
      const std::array<Vec3, 4> around = tilted(frame, normals[i]);
      for (size_t k = 0; k < a.rays.size(); ++k) {
        const Rgb share = a.radiance[k] * (2 * kPi / float(params.samples));
        for (size_t m = 0; m < 5; ++m) {
          const Vec3 normal = m < 4 ? around[m] : normals[i];
          light[i][m] += share * std::max(0.0f, dot(a.rays[k].direction, normal));
        }
      }
    }
    progress.advance(end - begin);
  });
  LUXEL_TRY_STATUS(stopped(progress));
  const auto add = [&](size_t i, transport::Elements& elements) {
    for (const Vec3& m : tilted(frame_around(normals[i]), normals[i]))
      add_element(elements, positions[i], m, geometric_normals[i]);
    add_element(elements, positions[i], normals[i], geometric_normals[i]);
  };
  const auto take = [&](size_t i, std::span<const Rgb> direct) {
    for (size_t m = 0; m < 5; ++m) light[i][m] += direct[m];
  };
  LUXEL_TRY(const uint64_t direct_rays, direct_by_normals(lit, n, 5, params, add, take, progress));
  BentLight out{std::vector<Bent>(n), n * uint64_t(params.samples) + direct_rays};
  for (size_t i = 0; i < n; ++i) {
    const std::array<Rgb, 4> e{light[i][0], light[i][1], light[i][2], light[i][3]};
    out.bent[i] = bent_from(frame_around(normals[i]), normals[i], e, light[i][4]);
  }
  return out;
}

}  // namespace luxel::light
