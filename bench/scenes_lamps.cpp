// Cost of many lamps.
#include <cmath>

#include "bench/scenes.h"
#include "luxel/scene/shapes.h"
#include "luxel/validate/agreement.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {
namespace {

/// A hall of 20 x 20 m, 4 m high, with pillars of 3 m and a grid of n x n lamps: squares just under
/// the ceiling, or points, which hang lower, because they would make hot spots on a ceiling near
/// by, whose indirect light is noisy whatever is done about direct light: what is compared is the
/// cost of many lamps. Every lamp has its share of the same flux.
scene::Scene hall(int n, bool squares) {
  scene::Scene s;
  const Rgb gray{0.6f, 0.6f, 0.6f};
  const uint32_t walls = scene::add_material(s, "walls", gray, {});
  scene::Mesh room;
  room.name = "hall";
  scene::add_box(room, {0, 0, 0}, {20, 4, 20}, walls);
  for (auto& t : room.triangles) std::swap(t[1], t[2]);  // seen from inside
  scene::place(s, std::move(room));
  // Nine pillars.
  scene::Mesh pillars;
  pillars.name = "pillars";
  for (int k = 0; k < 9; ++k) {
    const float x = 3.3f + 6.4f * float(k % 3), z = 3.1f + 6.6f * float(k / 3);
    scene::add_box(pillars, {x, 0, z}, {x + 0.5f, 3, z + 0.5f}, walls);
  }
  scene::place(s, std::move(pillars));
  // n x n lamps of one flux in all.
  const float share = 1 / float(n * n), side = 0.2f;
  const uint32_t lamp = scene::add_material(
      s, "lamp", {}, Rgb{1, 0.95f, 0.9f} * (squares ? 1000 * share / (kPi * side * side) : 0.0f));
  for (int k = 0; k < n * n; ++k) {
    const float x = 20 * (float(k % n) + 0.5f) / float(n),
                z = 20 * (float(k / n) + 0.5f) / float(n);
    if (squares) {
      scene::add_rectangle(s, {x - side / 2, x + side / 2, z - side / 2, z + side / 2}, 3.9f, false,
                           lamp);
      continue;
    }
    scene::PunctualLight point;
    point.position = {x, 2.9f, z};
    point.intensity = Rgb{1, 0.95f, 0.9f} * (1000 * share / (4 * kPi));
    s.lights.push_back(point);
  }
  return s;
}

struct Cost {
  double seconds = 0, error = 0;
};

/// Seconds (the best of three) and error of a bake with few rays, against one with many.
Result<Cost> cost_of(scene::Scene scene) {
  constexpr int kResolution = 192;
  Progress progress;
  LUXEL_TRY(const auto p, validate::prepare(std::move(scene), kResolution, progress));
  pipeline::BakeSettings settings;
  settings.samples = 64, settings.direct_samples = 32;
  validate::Timed few;
  few.seconds = HUGE_VAL;
  for (int k = 0; k < 3; ++k) {
    LUXEL_TRY(validate::Timed again, validate::solve(*p, "gather", settings, progress));
    if (again.seconds < few.seconds) few = std::move(again);
  }
  settings.samples = 1024, settings.direct_samples = 512, settings.seed = 2;
  LUXEL_TRY(const validate::Timed many, validate::solve(*p, "gather", settings, progress));
  return Cost{few.seconds,
              validate::errors_of(few.light.irradiance, many.light.irradiance, {}).relative};
}

/// Error falls with the root of time, at worst: the time to reach the other's error.
double time_at_equal_error(const Cost& cost, const Cost& other) {
  return cost.seconds * std::pow(cost.error / other.error, 2) / other.seconds;
}

}  // namespace

Status measure_lamps(Table& table) {
  for (const bool squares : {true, false}) {
    LUXEL_TRY(const Cost few, cost_of(hall(2, squares)));
    LUXEL_TRY(const Cost many, cost_of(hall(20, squares)));
    const double ratio = time_at_equal_error(many, few);
    table.notes.push_back(fmt::format(
        "Hall with 4 and with 400 {}: {:.2f} s to {:.2f} %, {:.2f} s to {:.2f} %: {:.2f} times the "
        "time at equal error.",
        squares ? "square lamps" : "point lamps", few.seconds, 100 * few.error, many.seconds,
        100 * many.error, ratio));
    table.json.push_back({{"scene", squares ? "hall, square lamps" : "hall, point lamps"},
                          {"seconds", {few.seconds, many.seconds}},
                          {"error", {few.error, many.error}},
                          {"time_at_equal_error", ratio}});
  }
  return {};
}

}  // namespace luxel::bench
