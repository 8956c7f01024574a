#include "luxel/solve/gather/budget/read_check.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/light/direct_light.h"
#include "luxel/light/shadow_rays.h"
#include "luxel/solve/gather/bounce/sweep.h"
#include "luxel/solve/gather/trace/near_paths.h"
#include "luxel/solve/gather/trace/sort_rays.h"
#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::gather {
namespace {

/// Rays from each place, and shadow rays towards each light: few, for errors vary from place to
/// place.
constexpr int kRaysOfPlace = 4, kShadowRaysOfPlace = 4;
/// That which meets a place counts, too.
constexpr uint64_t kRaysPerPlace = 1 + kRaysOfPlace + kShadowRaysOfPlace;
/// A bake's rays for each that checks; and bounds of the number of those.
constexpr uint64_t kSamplesPerRay = 32, kFewest = 1 << 15, kMost = 1 << 20;
/// The number where an error is asked for: light is known to some thousandths of itself by so many.
constexpr uint64_t kForError = 1 << 19;
/// Any number: it sets these random numbers apart from others of the same seed.
constexpr uint64_t kCheckSeed = 0xc4ec;

/// Rays of texels, and what they meet.
struct TexelRays {
  const light::TexelScene& in;
  const NearScene& near;
  std::span<const uint32_t> texels;  ///< that are seen
  const ReadCheckParams& params;

  trace::Ray ray(size_t k, size_t count) const;
  /// Whether it reads the map where it ends, as is.
  bool reads(const trace::Hit& hit) const;
};

trace::Ray TexelRays::ray(size_t k, size_t count) const {
  const transport::Elements& e = in.elements;
  const uint64_t seed = hash64(params.seed, kCheckSeed);
  // The k-th of equal parts of all texels, each in turn.
  const double jitter = double(unit_float(uint32_t(hash64(seed, k))));
  const size_t at = size_t((double(k) + jitter) / double(count) * double(texels.size()));
  const uint32_t i = texels[std::min(at, texels.size() - 1)];
  const Vec3 d = light::mirrored_above(
      frame_around(e.normal[i])
          .to_world(cosine_hemisphere_sample(sobol_owen_2d(uint32_t(k), hash64(seed)))),
      e.geometric_normal[i]);
  return {e.position[i], 0, d, INFINITY};
}

bool TexelRays::reads(const trace::Hit& hit) const {
  if (!hit.found() || hit.back_face) return false;
  if (scene::material_at(in.scene, hit.point()).diffuse_transmission > 0) return false;
  NearPath path;
  path.hit = hit;
  return !params.follows_near || !goes_on(near, path);
}

/// What of `count` rays reads the map, in their order.
std::vector<trace::Hit> hits_that_read(const TexelRays& from, size_t count) {
  std::vector<trace::Ray> rays(count);
  std::vector<trace::Hit> hits(count);
  parallel_for(count, 1024, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) rays[k] = from.ray(k, count);
    from.in.tracer.closest_hits(std::span(rays).subspan(begin, end - begin),
                                std::span(hits).subspan(begin, end - begin));
    for (size_t k = begin; k < end; ++k)
      if (!from.reads(hits[k])) hits[k] = {};
  });
  std::erase_if(hits, [](const trace::Hit& hit) { return !hit.found(); });
  return hits;
}

}  // namespace

uint64_t check_rays(uint64_t samples, bool asks_for_error) {
  const uint64_t part = std::min(samples / kSamplesPerRay, kMost);
  if (asks_for_error) return std::max(part, kForError);
  return part < kFewest ? 0 : part;
}

uint64_t check_bytes(uint64_t rays) {
  constexpr uint64_t kPerPlace =
      bytes_per_entry(&ReadCheck::read, &ReadCheck::reflectance, &ReadCheck::direct) +
      kTracedBytesPerElement + kRaysOfPlace * sizeof(StoredHit) + transport::kPlaceBytesPerElement +
      light::kDirectBytesPerElement;
  return rays / kRaysPerPlace * kPerPlace;
}

Result<ReadCheck> make_read_check(const light::TexelScene& in, const transport::OwnSides& sides,
                                  const TracedHits& hits, const ReadCheckParams& params,
                                  Progress& progress) {
  const std::vector<float> widths = texel_widths_m(in.scene, in.atlas);
  const NearScene near{in.scene, in.atlas, in.lights, in.tracer, widths, nullptr, &sides};
  // 1. Places that rays of texels meet.
  std::vector<uint32_t> texels;
  for (uint32_t i = 0; i < hits.size(); ++i)
    if (!is_hidden(hits, i)) texels.push_back(i);
  ReadCheck out;
  out.hits = no_hits(0);
  if (texels.empty()) return out;
  const size_t count = size_t(params.rays / kRaysPerPlace);
  const std::vector<trace::Hit> met = hits_that_read({in, near, texels, params}, count);
  // 2. What they send, and what is read there instead.
  transport::Elements places;
  places.position.resize(met.size()), places.normal.resize(met.size());
  places.geometric_normal.resize(met.size()), places.reflectance.resize(met.size());
  out.read.resize(met.size());
  parallel_for(met.size(), 256, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const transport::SmoothPoint p = transport::smooth_point(in.scene, met[k].point());
      places.position[k] = p.start, places.normal[k] = p.normal;
      places.geometric_normal[k] = p.geometric_normal;
      places.reflectance[k] = scene::reflectance_at(in.scene, met[k].point());
      out.read[k] = store(transport::own_lookup(sides, met[k].point()), {});
    }
  });
  // 3. The light that they get.
  const uint64_t seed = hash64(params.seed, kCheckSeed + 1);
  LUXEL_TRY(light::DirectLight direct,
            light::direct_light(in.scene, places, in.lights, in.tracer,
                                {.samples = kShadowRaysOfPlace, .seed = seed}, progress));
  out.direct = std::move(direct.irradiance);
  LUXEL_TRY(out.hits,
            trace_hits({in.scene, in.atlas, places, in.lights, in.tracer, &sides}, kRaysOfPlace,
                       {.seed = seed,
                        .scratch_folder = params.scratch_folder,
                        .follows_near = params.follows_near},
                       progress));
  out.reflectance.assign(places.reflectance.begin(), places.reflectance.end());
  return out;
}

Result<ReadError> read_error(const ReadCheck& check, const LightOfMap& light, Progress& progress) {
  if (check.size() == 0) return ReadError{};
  RadiosityMap m = empty_radiosity_map(light.map.resolution);
  fill_radiosity(m, light.map, light.elements, light.hits, light.behind, light.irradiance);
  std::vector<Rgb> irradiance(check.size());
  std::vector<float> variance(check.size()), split(check.size());
  Sweep sweep{.direct = check.direct,
              .irradiance = irradiance,
              .variance = variance,
              .split_variance = split};
  LUXEL_TRY_STATUS(run_sweep(m, check.hits, sweep, progress));
  // The ratio of two sums over places, and the standard error of such a ratio.
  std::vector<double> excess, source;
  double excesses = 0, sources = 0;
  for (size_t k = 0; k < check.size(); ++k) {
    if (is_hidden(check.hits, k)) continue;
    const Rgb rho = check.reflectance[k];
    const Float4 read = lookup(m, check.read[k]);
    excess.push_back(double(luminance(Rgb{read[0], read[1], read[2]} - rho * irradiance[k])));
    source.push_back(double(luminance(rho * source_of(check.hits, check.direct, k))));
    excesses += excess.back(), sources += source.back();
  }
  if (!(sources > 0)) return ReadError{};
  const double part = excesses / sources;
  double squares = 0;
  for (size_t k = 0; k < excess.size(); ++k)
    squares += (excess[k] - part * source[k]) * (excess[k] - part * source[k]);
  return ReadError{part, std::sqrt(squares) / sources};
}

}  // namespace luxel::gather
