// luxel bench gpu-direct: direct light on a graphics device beside that on the processor.
#include "bench/bench.h"
#include "bench/scenes_of_rays.h"
#include "luxel/base/clock.h"
#include "luxel/base/differences.h"
#include "luxel/base/parallel.h"
#include "luxel/light/device/direct_light_on_device.h"
#include "luxel/light/direct_light.h"

namespace luxel::bench {
namespace {

constexpr int kDirectResolution = 512;

/// Few where a processor plays the device.
int shadow_rays_for(const gpu::Device& device) {
  return device.type == VK_PHYSICAL_DEVICE_TYPE_CPU ? 2 : 64;
}

std::vector<float> luminances(std::span<const Rgb> light) {
  std::vector<float> out;
  for (const Rgb& l : light) out.push_back(luminance(l));
  return out;
}

struct DirectSeconds {
  double processor = 0;
  double device = 0;  ///< until it was done
  double whole = 0;   ///< with what is sent there and back
};

void add_direct_row(const std::string& scene, const light::DirectLight& expected,
                    const light::DirectLight& found, const DirectSeconds& s, Table& table) {
  const Differences d = differences(luminances(found.irradiance), luminances(expected.irradiance));
  const double rays = double(expected.rays);
  table.rows.push_back({scene, std::to_string(expected.irradiance.size()),
                        fmt::format("{:.1f}", rays * 1e-6), fmt::format("{:.3f}", s.processor),
                        fmt::format("{:.1f}", s.device * 1e3), fmt::format("{:.1f}", s.whole * 1e3),
                        fmt::format("{:.4f}", 100 * d.rms), fmt::format("{:.5f}", 100 * d.bias)});
  table.json.push_back({{"scene", scene},
                        {"elements", expected.irradiance.size()},
                        {"shadow_rays", rays},
                        {"processor_s", s.processor},
                        {"device_s", s.device},
                        {"whole_s", s.whole},
                        {"rms_difference", d.rms},
                        {"bias", d.bias}});
}

Status measure_direct_in(const std::string& name, scene::Scene loaded, const gpu::Device& device,
                         Table& table) {
  Progress progress;
  LUXEL_TRY(const auto p, validate::prepare(std::move(loaded), kDirectResolution, progress));
  if (p->tracer->has_tints() || !light::device_knows(p->scene, p->lights)) {
    table.notes.push_back(name + " is left out: the device does not know its lights or its glass");
    return {};
  }
  const light::DirectParams params{.samples = shadow_rays_for(device)};
  DirectSeconds seconds;
  auto start = Clock::now();
  LUXEL_TRY(const light::DirectLight expected,
            light::direct_light(p->scene, p->elements, p->lights, *p->tracer, params, progress));
  seconds.processor = seconds_since(start);
  LUXEL_TRY(const trace::DeviceRayTracer tracer, trace::DeviceRayTracer::build(device, p->scene));
  LUXEL_TRY(gpu::Commands commands, gpu::Commands::make(device));
  LUXEL_TRY(light::DeviceDirectLight direct,
            light::DeviceDirectLight::make(tracer, commands, p->scene, p->lights));
  // The second time counts.
  const light::LitElements lit{p->scene, p->elements, p->lights, *p->tracer, &direct};
  LUXEL_TRY(light::DirectLight found, light::direct_light(lit, params, progress));
  const double before = direct.seconds();
  start = Clock::now();
  LUXEL_TRY(found, light::direct_light(lit, params, progress));
  seconds.whole = seconds_since(start), seconds.device = direct.seconds() - before;
  add_direct_row(name, expected, found, seconds, table);
  return {};
}

}  // namespace

Result<Table> measure_gpu_direct(const std::filesystem::path& shared, int threads) {
  const ThreadLimit limit(threads);
  Table table = new_table(
      "gpu-direct", {"scene", "texels", "shadow rays [millions]", "processor [s]", "device [ms]",
                     "whole [ms]", "RMS difference [% of the mean]", "bias [%]"});
  LUXEL_TRY(const auto device, gpu::Device::open({}));
  table.notes.push_back("device: " + device->name);
  if (!device->has_doubles)
    return fail(ErrorCode::unsupported, "{} has no double precision, which direct light needs",
                device->name);
  for (const NamedScene& named : scenes_of_rays(shared)) {
    if (!is_here(named, table)) continue;
    LUXEL_TRY(scene::Scene scene, load(named));
    LUXEL_TRY_STATUS(measure_direct_in(named.name, std::move(scene), *device, table));
  }
  return table;
}

}  // namespace luxel::bench
