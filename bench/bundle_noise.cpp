// Noise of light when texels share directions.
#include <cmath>
#include <map>

#include "bench/bundles.h"
#include "luxel/base/parallel.h"
#include "luxel/import/import.h"
#include "luxel/light/surroundings.h"
#include "luxel/solve/gather/gather.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::bench {
namespace {

constexpr int kNoiseMap = 256, kNoiseRays = 64;

/// A scene whose light is known, and who looks at it with which random numbers.
struct NoiseScene {
  const validate::Prepared& p;
  std::span<const Rgb> irradiance;
  bool shares_directions = false;
  uint64_t seed = 1;

  uint64_t seed_of(uint32_t i) const {
    const atlas::Texel& t = p.map.texels[i];
    const uint32_t set = t.y % kSetSide * kSetSide + t.x % kSetSide;
    return gather::seed_of_rays(
        seed, shares_directions ? size_t(p.atlas.chart[t.triangle_number]) * kSets + set : i);
  }
};

/// pi times the radiance that a ray brings.
Rgb light_along(const NoiseScene& in, const trace::Hit& hit, Vec3 direction) {
  const scene::Scene& scene = in.p.scene;
  if (!hit.found()) return light::soft_radiance(scene, in.p.lights.around, direction) * kPi;
  if (hit.back_face && !scene::reflects_from_behind(scene::material_at(scene, hit.point())))
    return {};
  const transport::TexelField field{&in.p.atlas, &in.p.map, in.irradiance};
  return transport::radiosity_at(scene, hit.point(), [&](const scene::SurfacePoint& p) {
    return transport::irradiance_at(field, p);
  });
}

/// Luminance of the light that each texel gathers.
std::vector<float> gathered_light(const NoiseScene& in) {
  const transport::Elements& e = in.p.elements;
  std::vector<float> out(e.size());
  parallel_for(out.size(), 256, [&](size_t begin, size_t end) {
    gather::RayBatch batch;
    std::vector<trace::Hit> hits(kNoiseRays);
    for (size_t i = begin; i < end; ++i) {
      gather::fill_rays(e.position[i], e.normal[i], e.geometric_normal[i], in.seed_of(uint32_t(i)),
                        {0, uint32_t(kNoiseRays)}, batch);
      in.p.tracer->closest_hits(batch.rays, hits);
      for (size_t k = 0; k < hits.size(); ++k)
        out[i] += luminance(light_along(in, hits[k], batch.rays[k].direction)) / kNoiseRays;
    }
  });
  return out;
}

/// Root mean square noise of the means over squares of texels of a chart, from two results without
/// a common random number. Squares that a chart covers for less than a half are left out.
double noise_of_means(const validate::Prepared& p, std::span<const float> a,
                      std::span<const float> b, uint32_t side) {
  struct Square {
    double difference = 0;
    uint32_t texels = 0;
  };
  std::map<std::array<uint32_t, 3>, Square> squares;
  for (size_t i = 0; i < a.size(); ++i) {
    const atlas::Texel& t = p.map.texels[i];
    Square& square = squares[{p.atlas.chart[t.triangle_number], t.x / side, t.y / side}];
    square.difference += double(a[i]) - double(b[i]), ++square.texels;
  }
  double sum = 0, count = 0;
  for (const auto& [key, square] : squares) {
    if (2 * square.texels < side * side) continue;
    const double mean = square.difference / square.texels;
    sum += mean * mean / 2, count += 1;
  }
  return std::sqrt(sum / count);
}

}  // namespace

Status measure_shared_noise(const std::filesystem::path& file, const std::string& name,
                            Table& table) {
  LUXEL_TRY(import::Imported imported, import::import_scene(file));
  Progress progress;
  LUXEL_TRY(const auto p, validate::prepare(std::move(imported.scene), kNoiseMap, progress));
  LUXEL_TRY(const gather::Gather light, gather::gather(p->input(), nullptr, {}, {}, {}, progress));
  double mean = 0;
  for (const Rgb& e : light.irradiance) mean += double(luminance(e)) / double(p->elements.size());
  std::string note = fmt::format("{}, {} rays: noise over mean light", name, kNoiseRays);
  for (const bool shares : {false, true}) {
    const auto a = gathered_light({*p, light.irradiance, shares, 1}),
               b = gathered_light({*p, light.irradiance, shares, 2});
    const auto noise = [&](uint32_t side) { return noise_of_means(*p, a, b, side) / mean; };
    note += fmt::format("{} {} of texels, {} of means over 8 x 8, {} over 32 x 32",
                        shares ? "; with shared directions" : "", percent(noise(1)),
                        percent(noise(8)), percent(noise(32)));
    table.json.push_back({{"scene", name},
                          {"shares_directions", shares},
                          {"noise", noise(1)},
                          {"noise_of_8_x_8", noise(8)},
                          {"noise_of_32_x_32", noise(32)}});
  }
  table.notes.push_back(note + ".");
  return {};
}

}  // namespace luxel::bench
