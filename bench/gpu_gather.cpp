// luxel bench gpu-gather: gather's first round and its sweeps on a graphics device beside those on
// the processor.
#include <algorithm>
#include <cmath>
#include <optional>

#include "bench/bench.h"
#include "bench/scenes_of_rays.h"
#include "luxel/base/clock.h"
#include "luxel/base/differences.h"
#include "luxel/base/parallel.h"
#include "luxel/light/device/direct_light_on_device.h"
#include "luxel/solve/device/device_sweep.h"
#include "luxel/solve/device/landed_rays.h"
#include "luxel/solve/gather/bounce/sweep.h"
#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::bench {
namespace {

constexpr int kGatherResolution = 512;
constexpr int kSweeps = 5;  ///< on the processor
/// Sweeps on the device, which also raise the clock of an idle one for the rays after them.
constexpr double kSecondsOfSweeps = 0.4;

/// Few where a processor plays the device.
int samples_for(const gpu::Device& device) {
  return device.type == VK_PHYSICAL_DEVICE_TYPE_CPU ? 16 : 256;
}

/// Light that all texels have, on both: E = 1 under white light.
gather::RadiosityMap even_map(const validate::Prepared& p, const gather::TracedHits& hits) {
  gather::RadiosityMap out = gather::empty_radiosity_map(p.map.resolution);
  const std::vector<Rgb> even(p.elements.size(), Rgb{1, 1, 1});
  gather::fill_radiosity(out, p.map, p.elements, hits, {}, even);
  return out;
}

/// Light that rays bring from the map: luminance per element, the mean over its rays.
struct Swept {
  std::vector<float> light;
  double seconds = 0;  ///< of the fastest sweep
};

Result<Swept> sweep_on_processor(const gather::RadiosityMap& map, const gather::TracedHits& hits) {
  const size_t n = hits.size();
  std::vector<Rgb> irradiance(n);
  std::vector<float> variance(n), split(n);
  Swept out;
  out.seconds = INFINITY;
  for (int k = 0; k < kSweeps; ++k) {
    Progress progress;
    gather::Sweep sweep{.irradiance = irradiance, .variance = variance, .split_variance = split};
    const auto start = Clock::now();
    LUXEL_TRY_STATUS(gather::run_sweep(map, hits, sweep, progress));
    out.seconds = std::min(out.seconds, seconds_since(start));
  }
  for (const Rgb& e : irradiance) out.light.push_back(luminance(e));
  return out;
}

/// The fastest of sweeps that take `least_s` together.
Result<Swept> sweep_on_device(gpu::Commands& commands, device::LandedRays& rays,
                              const gather::RadiosityMap& map, int samples, double least_s) {
  std::vector<on_device::Gathered> gathered(rays.element_count);
  Swept out;
  out.seconds = INFINITY;
  const auto start = Clock::now();
  do {
    LUXEL_TRY(const double seconds, device::sweep(commands, rays, map, gathered));
    out.seconds = std::min(out.seconds, seconds);
  } while (seconds_since(start) < least_s);
  for (const on_device::Gathered& g : gathered)
    out.light.push_back(luminance(g.sum) / float(samples));
  return out;
}

struct Measured {
  size_t elements = 0;
  int samples = 0;
  double rays_s = 0;  ///< on the processor
  device::LandedSeconds landed;
  double round_s = 0;      ///< of the device's round, with all that is sent there and back
  uint64_t left_open = 0;  ///< rays
  Swept processor, device;
};

void add_row(const std::string& scene, const Measured& m, Table& table) {
  const double rays = double(m.elements) * m.samples;
  const Differences d = differences(m.device.light, m.processor.light);
  table.rows.push_back({scene, std::to_string(m.elements), fmt::format("{:.1f}", rays * 1e-6),
                        fmt::format("{:.2f}", m.rays_s),
                        fmt::format("{:.1f}", m.processor.seconds * 1e3),
                        fmt::format("{:.1f}", m.landed.device * 1e3),
                        fmt::format("{:.1f}", 100 * double(m.left_open) / rays),
                        fmt::format("{:.2f}", m.landed.processor), fmt::format("{:.2f}", m.round_s),
                        fmt::format("{:.2f}", m.device.seconds * 1e3),
                        fmt::format("{:.4f}", 100 * d.rms), fmt::format("{:.5f}", 100 * d.bias)});
  table.json.push_back({{"scene", scene},
                        {"elements", m.elements},
                        {"rays", rays},
                        {"processor_rays_s", m.rays_s},
                        {"processor_sweep_s", m.processor.seconds},
                        {"device_rays_s", m.landed.device},
                        {"left_open", m.left_open},
                        {"left_open_s", m.landed.processor},
                        {"device_round_s", m.round_s},
                        {"device_sweep_s", m.device.seconds},
                        {"rms_difference", d.rms},
                        {"bias", d.bias}});
}

Status measure_gather_in(const std::string& name, scene::Scene loaded, const gpu::Device& device,
                         Table& table) {
  Progress progress;
  LUXEL_TRY(const auto p, validate::prepare(std::move(loaded), kGatherResolution, progress));
  if (p->tracer->has_tints()) {
    table.notes.push_back(name + " is left out: the device knows no coloured glass");
    return {};
  }
  const transport::OwnSides sides =
      transport::find_own_sides(p->scene, p->atlas, p->map, *p->tracer);
  const gather::TraceScene in = gather::trace_scene(p->input(), &sides);
  const gather::TraceParams params{.seed = 1, .follows_near = true};
  Measured m;
  m.elements = p->elements.size(), m.samples = samples_for(device);
  const auto start = Clock::now();
  LUXEL_TRY(const gather::TracedHits expected, gather::trace_hits(in, m.samples, params, progress));
  m.rays_s = seconds_since(start);
  const gather::RadiosityMap map = even_map(*p, expected);
  LUXEL_TRY(m.processor, sweep_on_processor(map, expected));

  LUXEL_TRY(trace::DeviceRayTracer tracer, trace::DeviceRayTracer::build(device, p->scene));
  LUXEL_TRY(gpu::Commands commands, gpu::Commands::make(device));
  std::optional<light::DeviceDirectLight> light;
  if (device.has_doubles && light::device_knows(p->scene, p->lights)) {
    LUXEL_TRY(light::DeviceDirectLight made,
              light::DeviceDirectLight::make(tracer, commands, p->scene, p->lights));
    light.emplace(std::move(made));
  }
  const device::DeviceScene on_device{tracer, commands, in, light ? &*light : nullptr};
  const std::vector<uint16_t> target(m.elements, uint16_t(m.samples));
  // The second time counts.
  for (int k = 0; k < 2; ++k) {
    gather::TracedHits hits = gather::no_hits(p->elements.size());
    m.landed = {};
    const auto begin = Clock::now();
    LUXEL_TRY(device::LandedRays landed, device::begin_rays(on_device, params));
    LUXEL_TRY_STATUS(
        device::land_round(on_device, target, {}, params, landed, hits, m.landed, progress));
    m.round_s = seconds_since(begin), m.left_open = landed.left_open;
    LUXEL_TRY(m.device, sweep_on_device(commands, landed, map, m.samples, kSecondsOfSweeps));
  }
  add_row(name, m, table);
  return {};
}

}  // namespace

Result<Table> measure_gpu_gather(const std::filesystem::path& shared, int threads) {
  const ThreadLimit limit(threads);
  Table table = new_table(
      "gpu-gather",
      {"scene", "texels", "rays [millions]", "processor: rays [s]", "a sweep [ms]",
       "device: rays [ms]", "left to the processor [%]", "ended there in [s]", "whole round [s]",
       "a sweep on the device [ms]", "RMS difference [% of the mean]", "bias [%]"});
  LUXEL_TRY(const auto device, gpu::Device::open({}));
  table.notes.push_back("device: " + device->name);
  for (const NamedScene& named : scenes_of_rays(shared)) {
    if (!is_here(named, table)) continue;
    LUXEL_TRY(scene::Scene scene, load(named));
    LUXEL_TRY_STATUS(measure_gather_in(named.name, std::move(scene), *device, table));
  }
  return table;
}

}  // namespace luxel::bench
