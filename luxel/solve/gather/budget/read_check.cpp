#include "luxel/solve/gather/budget/read_check.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/light/direct_light.h"
#include "luxel/light/shadow_rays.h"
#include "luxel/solve/gather/bounce/sweep.h"
#include "luxel/solve/gather/budget/adaptive.h"
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
constexpr double kReflectsTenfold = 0.9;
/// The fewest rays of a group, half of them for either of two answers: of large maps several texels
/// beside each other are one.
constexpr size_t kFewestOfGroup = 32;
/// So many groups' worth of the mean over all charts is added to those of a chart, which may be
/// few.
constexpr double kPriorGroups = 8;
/// Any number: it sets these random numbers apart from others of the same seed.
constexpr uint64_t kCheckSeed = 0xc4ec;

/// Rays of texels, and what they meet.
struct TexelRays {
  const light::TexelScene& in;
  const NearScene& near;
  std::span<const uint32_t> texels;  ///< that are seen
  const ReadCheckParams& params;

  trace::Ray ray(size_t k, size_t count) const;
  /// True: a ray that ends at this hit reads the map there, as is.
  bool reads(const trace::Hit& hit) const;
};

trace::Ray TexelRays::ray(size_t k, size_t count) const {
  const transport::Elements& e = in.elements;
  const uint64_t seed = hash64(params.seed, kCheckSeed);
  // The k-th of equal parts of all texels, each in turn.
  const double jitter = double(unit_float(uint32_t(hash64(seed, k))));
  const size_t at = size_t((double(k) + jitter) / double(count) * double(texels.size()));
  const uint32_t i = texels[std::min(at, texels.size() - 1)];
  // Even and odd ones share no random number.
  const Vec2 u = sobol_owen_2d(uint32_t(k / 2), hash64(seed, k % 2));
  const Vec3 d = light::mirrored_above(
      frame_around(e.normal[i]).to_world(cosine_hemisphere_sample(u)), e.geometric_normal[i]);
  return {e.position[i], 0, d, INFINITY};
}

bool TexelRays::reads(const trace::Hit& hit) const {
  if (!hit.found() || hit.back_face) return false;
  if (scene::material_at(in.scene, hit.point()).diffuse_transmission > 0) return false;
  NearPath path;
  path.hit = hit;
  return !params.follows_near || !goes_on(near, path);
}

/// Those of `count` rays that read the map, in their order, and their numbers.
std::vector<trace::Hit> hits_that_read(const TexelRays& from, size_t count,
                                       std::vector<uint32_t>& numbers) {
  std::vector<trace::Ray> rays(count);
  std::vector<trace::Hit> hits(count);
  parallel_for(count, 1024, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) rays[k] = from.ray(k, count);
    from.in.tracer.closest_hits(std::span(rays).subspan(begin, end - begin),
                                std::span(hits).subspan(begin, end - begin));
    for (size_t k = begin; k < end; ++k)
      if (!from.reads(hits[k])) hits[k] = {};
  });
  for (uint32_t k = 0; k < count; ++k)
    if (hits[k].found()) numbers.push_back(k);
  std::erase_if(hits, [](const trace::Hit& hit) { return !hit.found(); });
  return hits;
}

/// The answer of one place: by how much more it seems to send than it does, and what it sends of
/// light that has not been reflected before; luminances [W/m^2].
struct AtPlace {
  double read = 0, excess = 0, source = 0;
};

/// A group's mean excess over all its rays, less the part that all share, is what its texels read
/// too much. Even and odd rays tell it twice, and their noise drops out of the product.
void measure_apart(const ReadCheck& check, std::span<const AtPlace> places,
                   std::span<const Rgb> irradiance, ReadError& out) {
  struct Half {
    double off = 0, read = 0;
  };
  std::vector<std::array<Half, 2>> groups(check.texel_of_group.size());
  for (size_t k = 0; k < places.size(); ++k) {
    const size_t group = check.ray[k] / check.rays_of_group;
    if (group >= groups.size()) continue;  // not a whole one
    Half& half = groups[group][check.ray[k] % 2];
    half.off += places[k].excess - out.part * places[k].source, half.read += places[k].read;
  }
  const double darkest = double(darkest_light(irradiance));
  const double rays_of_half = double(check.rays_of_group) / 2;
  double off = 0, read = 0, all = 0;
  std::vector<double> by_chart(check.charts), count(check.charts);
  for (size_t g = 0; g < groups.size(); ++g) {
    const auto& [even, odd] = groups[g];
    const double own = double(luminance(irradiance[check.texel_of_group[g]]));
    const double light = std::max(own, darkest) * rays_of_half;
    off += even.off * odd.off, read += even.read * odd.read;
    if (!(light > 0)) continue;
    const double square = even.off * odd.off / (light * light);
    by_chart[check.chart_of_group[g]] += square, count[check.chart_of_group[g]] += 1, all += square;
  }
  if (!(read > 0)) return;
  out.square_apart = std::max(0.0, off / read);
  for (size_t c = 0; c < by_chart.size(); ++c) {
    const double prior = kPriorGroups * all / double(groups.size());
    out.relative_square_apart.push_back(
        float(std::max(0.0, (by_chart[c] + prior) / (count[c] + kPriorGroups))));
  }
}

}  // namespace

uint64_t check_rays(uint64_t samples, bool asks_for_error, std::span<const Rgb> reflectance) {
  double rho = 0;
  for (const Rgb& r : reflectance) rho += double(luminance(r)) / double(reflectance.size());
  const bool counts = asks_for_error || rho > kReflectsTenfold;
  const uint64_t part = std::min(samples / kSamplesPerRay, kMost);
  if (counts) return std::max(part, kForError);
  return part < kFewest ? 0 : part;
}

uint64_t check_bytes(uint64_t rays) {
  constexpr uint64_t kPerPlace = bytes_per_entry(&ReadCheck::read, &ReadCheck::reflectance,
                                                 &ReadCheck::direct, &ReadCheck::ray) +
                                 kTracedBytesPerElement + kRaysOfPlace * sizeof(StoredHit) +
                                 transport::kPlaceBytesPerElement + light::kDirectBytesPerElement;
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
  const std::vector<trace::Hit> met = hits_that_read({in, near, texels, params}, count, out.ray);
  out.rays_of_group = std::max(kFewestOfGroup, count / texels.size());
  for (size_t first = 0; first + out.rays_of_group <= count; first += out.rays_of_group) {
    const uint32_t i = texels[(first + out.rays_of_group / 2) * texels.size() / count];
    out.texel_of_group.push_back(i);
    out.chart_of_group.push_back(in.atlas.chart[in.map.texels[i].triangle_number]);
  }
  out.charts = size_t(in.atlas.chart_count);
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
  std::vector<AtPlace> places(check.size());
  double excess = 0, source = 0;
  for (size_t k = 0; k < check.size(); ++k) {
    if (is_hidden(check.hits, k)) continue;
    const Rgb rho = check.reflectance[k];
    const Float4 by_map = lookup(m, check.read[k]);
    const Rgb read{by_map[0], by_map[1], by_map[2]};
    places[k] = {double(luminance(read)), double(luminance(read - rho * irradiance[k])),
                 double(luminance(rho * source_of(check.hits, check.direct, k)))};
    excess += places[k].excess, source += places[k].source;
  }
  if (!(source > 0)) return ReadError{};
  const double part = excess / source;
  double squares = 0;
  for (const AtPlace& at : places)
    squares += (at.excess - part * at.source) * (at.excess - part * at.source);
  ReadError out{.part = part, .standard_error = std::sqrt(squares) / source};
  measure_apart(check, places, light.irradiance, out);
  return out;
}

}  // namespace luxel::gather
