#include "luxel/solve/matrix/live_light.h"

#include <algorithm>
#include <array>
#include <functional>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/light/lights.h"

namespace luxel::matrix {
namespace {

/// Places whose shadow rays go together: packets of neighbours, on the stack.
constexpr size_t kBatch = 64;

/// Light that arrives if nothing is in the way of `ray`; zero when none would.
struct Arriving {
  Rgb irradiance;
  trace::Ray ray;
};

Arriving arriving_at(const LitPoints& points, size_t i, const scene::PunctualLight& light) {
  const light::PunctualIncidence in = light::incidence_at(light, {}, points.position[i]);
  const float cosine = dot(points.normal[i], in.towards);
  if (!(cosine > 0) || !(dot(points.geometric_normal[i], in.towards) > 0)) return {};
  return {in.irradiance * cosine, {points.position[i], 0, in.towards, in.reach_m}};
}

/// Adds one light's irradiance to the points [begin, end), at most kBatch.
void add_light(const LitPoints& points, const scene::PunctualLight& light,
               const trace::RayTracer& tracer, size_t begin, size_t end,
               std::span<Rgb> irradiance) {
  std::array<trace::Ray, kBatch> ray;
  std::array<uint32_t, kBatch> place;
  std::array<Rgb, kBatch> light_of_ray;
  std::array<uint8_t, kBatch> blocked;
  size_t count = 0;
  for (size_t i = begin; i < end; ++i) {
    const Arriving a = arriving_at(points, i, light);
    if (!(max_component(a.irradiance) > 0)) continue;
    ray[count] = a.ray, place[count] = uint32_t(i), light_of_ray[count] = a.irradiance;
    ++count;
  }
  tracer.occluded(std::span(ray).first(count), std::span(blocked).first(count));
  for (size_t k = 0; k < count; ++k)
    if (!blocked[k]) irradiance[place[k]] += light_of_ray[k];
}

}  // namespace

Rgb live_light_at(const LitPoints& points, size_t place,
                  std::span<const scene::PunctualLight> lights, const trace::RayTracer& tracer) {
  Rgb sum{};
  for (const scene::PunctualLight& light : lights) {
    const Arriving a = arriving_at(points, place, light);
    uint8_t blocked = 0;
    if (!(max_component(a.irradiance) > 0)) continue;
    tracer.occluded({&a.ray, 1}, {&blocked, 1});
    if (!blocked) sum += a.irradiance;
  }
  return sum;
}

void live_light(const LitPoints& points, std::span<const scene::PunctualLight> lights,
                const trace::RayTracer& tracer, std::span<Rgb> irradiance) {
  LUXEL_CHECK(irradiance.size() == points.size() && points.normal.size() == points.size());
  const auto batch = [&](size_t begin, size_t end) {
    std::fill(irradiance.begin() + std::ptrdiff_t(begin), irradiance.begin() + std::ptrdiff_t(end),
              Rgb{});
    for (const scene::PunctualLight& light : lights)
      add_light(points, light, tracer, begin, end, irradiance);
  };
  parallel_for(points.size(), kBatch, std::ref(batch));
}

}  // namespace luxel::matrix
