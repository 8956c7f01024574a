// luxel bench gpu: rays on a graphics device beside those on the processor.
#include <algorithm>

#include "bench/bench.h"
#include "bench/scenes_of_rays.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/solve/device/first_hits.h"
#include "luxel/trace/vulkan/device_ray_tracer.h"

namespace luxel::bench {
namespace {

constexpr int kRaysPerElement = 64;
constexpr double kWarmUpSeconds = 0.3, kMeasuredSeconds = 0.3;
/// Rays of a scene, at most: 4 ms of a fast device, and a second of a slow one.
constexpr size_t kMostRays = 1u << 24, kMostRaysOfProcessor = 1u << 17;
/// Elements whose rays of one cell of directions follow each other.
constexpr size_t kTogether = 64;

size_t most_rays(const gpu::Device& device) {
  return device.type == VK_PHYSICAL_DEVICE_TYPE_CPU ? kMostRaysOfProcessor : kMostRays;
}

/// Gather's rays of groups of neighbouring elements, spread over the map.
struct Rays {
  std::vector<trace::Ray> by_element;  ///< all rays of an element after each other
  std::vector<trace::Ray> sorted;      ///< those of a group by cells of directions
};

Rays rays_of(const validate::Prepared& p, size_t most) {
  const size_t groups = p.elements.size() / kTogether;
  const size_t wanted = std::min(groups, most / (kTogether * kRaysPerElement));
  Rays out;
  out.by_element.resize(wanted * kTogether * kRaysPerElement);
  out.sorted.resize(out.by_element.size());
  parallel_for(wanted, 1, [&](size_t begin, size_t end) {
    for (size_t g = begin; g < end; ++g) {
      const size_t first = g * groups / wanted * kTogether;
      for (size_t k = 0; k < kTogether; ++k) {
        const size_t i = first + k;
        const std::span own =
            std::span(out.by_element)
                .subspan((g * kTogether + k) * kRaysPerElement, size_t(kRaysPerElement));
        gather::element_rays(p.elements.position[i], p.elements.normal[i],
                             p.elements.geometric_normal[i], gather::seed_of_rays(1, i), own);
        for (size_t s = 0; s < size_t(kRaysPerElement); ++s)
          out.sorted[(g * size_t(kRaysPerElement) + s) * kTogether + k] = own[s];
      }
    }
  });
  return out;
}

/// Rays per second of the processor.
double processor_rate(const trace::RayTracer& tracer, std::span<const trace::Ray> rays,
                      std::span<trace::Hit> hits) {
  const auto start = Clock::now();
  parallel_for(rays.size(), 4096, [&](size_t begin, size_t end) {
    tracer.closest_hits(rays.subspan(begin, end - begin), hits.subspan(begin, end - begin));
  });
  return double(rays.size()) / seconds_since(start);
}

/// Rays per second: the median of rounds, after others in which a device's clock rises. A round
/// returns the seconds that it took.
Result<double> median_rate(size_t rays, const std::function<Result<double>()>& round) {
  std::vector<double> rates;
  double spent_s = 0;
  while (spent_s < kWarmUpSeconds + kMeasuredSeconds || rates.empty()) {
    LUXEL_TRY(const double seconds, round());
    if (spent_s >= kWarmUpSeconds) rates.push_back(double(rays) / seconds);
    spent_s += seconds;
  }
  std::ranges::sort(rates);
  return rates[rates.size() / 2];
}

/// The rate of rays that lie on the device.
Result<double> device_rate(trace::DeviceRayTracer& tracer, std::span<const trace::Ray> rays) {
  LUXEL_TRY(trace::DeviceRays there, tracer.upload(rays));
  return median_rate(rays.size(), [&] { return tracer.closest_hits(there); });
}

/// The share of rays that meet another triangle, or the other side of it.
double share_of_others(std::span<const trace::Hit> a, std::span<const trace::Hit> b) {
  size_t others = 0;
  for (size_t i = 0; i < a.size(); ++i)
    others += a[i].instance != b[i].instance || a[i].triangle != b[i].triangle ||
              a[i].back_face != b[i].back_face;
  return double(others) / double(std::max<size_t>(a.size(), 1));
}

/// The share of rays that end elsewhere, by more than rounding: what is left of those that meet
/// another triangle where surfaces do not coincide.
double share_of_other_places(std::span<const trace::Hit> a, std::span<const trace::Hit> b) {
  constexpr float kRounding = 1e-4f;
  size_t others = 0;
  for (size_t i = 0; i < a.size(); ++i)
    others += a[i].found() != b[i].found() ||
              (a[i].found() && std::abs(a[i].t - b[i].t) > kRounding * (1 + a[i].t));
  return double(others) / double(std::max<size_t>(a.size(), 1));
}

/// The rate of gather's rays of the first elements, as many as fit, made and traced on the device.
Result<double> made_rate(const trace::DeviceRayTracer& tracer, const validate::Prepared& p,
                         size_t most) {
  LUXEL_TRY(gpu::Commands commands, gpu::Commands::make(tracer.device()));
  const size_t fit = std::max<size_t>(kTogether, most / kRaysPerElement);
  transport::Elements some = p.elements;
  for (auto* values : {&some.position, &some.normal, &some.geometric_normal})
    values->resize(std::min(values->size(), fit));
  some.reflectance.clear();
  LUXEL_TRY(device::FirstHits hits,
            device::prepare_first_hits(tracer, commands, some, {kRaysPerElement, 1}));
  return median_rate(hits.element_count * kRaysPerElement,
                     [&] { return device::trace_first_hits(tracer, commands, hits); });
}

/// Results of one kind of hierarchy with a scene's rays.
struct DeviceRates {
  size_t triangles = 0;
  double built_s = 0;
  double by_element = 0, sorted = 0;  ///< rays per second
  double made = 0;                    ///< of rays that the device makes itself
  double others = 0;                  ///< share of rays that meet another triangle
  double elsewhere = 0;               ///< share of rays that end at another place
};

Result<DeviceRates> rates_on_device(const gpu::Device& device, const validate::Prepared& p,
                                    trace::HierarchyKind kind, const Rays& rays,
                                    std::span<const trace::Hit> expected) {
  DeviceRates out;
  const auto start = Clock::now();
  LUXEL_TRY(trace::DeviceRayTracer tracer, trace::DeviceRayTracer::build(device, p.scene, kind));
  out.built_s = seconds_since(start), out.triangles = tracer.triangles();
  LUXEL_TRY(out.by_element, device_rate(tracer, rays.by_element));
  LUXEL_TRY(out.sorted, device_rate(tracer, rays.sorted));
  LUXEL_TRY(out.made, made_rate(tracer, p, most_rays(device)));
  std::vector<trace::Hit> hits(rays.sorted.size());
  LUXEL_TRY_STATUS(tracer.closest_hits(rays.sorted, hits));
  out.others = share_of_others(expected, hits);
  out.elsewhere = share_of_other_places(expected, hits);
  return out;
}

void add_row(const std::string& scene, size_t rays, trace::HierarchyKind kind, double processor,
             const DeviceRates& on_device, Table& table) {
  const std::string name(name_of(kind));
  table.rows.push_back(
      {scene, std::to_string(on_device.triangles), fmt::format("{:.1f}", double(rays) * 1e-6),
       fmt::format("{:.2f}", processor * 1e-6), name,
       fmt::format("{:.1f}", on_device.by_element * 1e-6),
       fmt::format("{:.1f}", on_device.sorted * 1e-6), fmt::format("{:.1f}", on_device.made * 1e-6),
       fmt::format("{:.4f}", 100 * on_device.others),
       fmt::format("{:.5f}", 100 * on_device.elsewhere),
       fmt::format("{:.0f}", on_device.built_s * 1e3)});
  table.json.push_back({{"scene", scene},
                        {"triangles", on_device.triangles},
                        {"rays", rays},
                        {"processor_mrays_per_s", processor * 1e-6},
                        {"hierarchy", name},
                        {"device_mrays_per_s", on_device.by_element * 1e-6},
                        {"device_sorted_mrays_per_s", on_device.sorted * 1e-6},
                        {"device_made_mrays_per_s", on_device.made * 1e-6},
                        {"share_of_other_triangles", on_device.others},
                        {"share_of_other_places", on_device.elsewhere},
                        {"build_s", on_device.built_s}});
}

Status measure_scene(const std::string& name, scene::Scene loaded, const gpu::Device& device,
                     Table& table) {
  Progress layout;
  LUXEL_TRY(const auto p, validate::prepare(std::move(loaded), 512, layout));
  const Rays rays = rays_of(*p, most_rays(device));
  std::vector<trace::Hit> expected(rays.sorted.size());
  const double processor = processor_rate(*p->tracer, rays.sorted, expected);
  using trace::HierarchyKind;
  for (const HierarchyKind kind :
       {HierarchyKind::binary, HierarchyKind::wide, HierarchyKind::driver}) {
    if (kind == HierarchyKind::driver && !device.has_ray_queries) continue;
    LUXEL_TRY(const DeviceRates on_device, rates_on_device(device, *p, kind, rays, expected));
    add_row(name, rays.sorted.size(), kind, processor, on_device, table);
  }
  return {};
}

}  // namespace

Result<Table> measure_gpu(const std::filesystem::path& shared, int threads) {
  const ThreadLimit limit(threads);
  Table table = new_table(
      "gpu", {"scene", "triangles", "rays [millions]", "processor, Mrays/s", "hierarchy",
              "device, Mrays/s", "device, rays sorted, Mrays/s", "rays made there, Mrays/s",
              "rays that meet another triangle [%]", "another place [%]", "built in [ms]"});
  LUXEL_TRY(const auto device, gpu::Device::open({}));
  table.notes.push_back("device: " + device->name);
  for (const NamedScene& named : scenes_of_rays(shared)) {
    if (!is_here(named, table)) continue;
    LUXEL_TRY(scene::Scene scene, load(named));
    LUXEL_TRY_STATUS(measure_scene(named.name, std::move(scene), *device, table));
  }
  return table;
}

}  // namespace luxel::bench
