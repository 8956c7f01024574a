// The formulas of direct light that the processor and a device share give the same on both. Skipped
// without a device.
#include <gmock/gmock.h>

#include <cstring>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/gpu/device_test_support.h"
#include "luxel/gpu/pipeline.h"
#include "luxel/light/both_bright_texel.h"
#include "luxel/light/both_light_group.h"
#include "luxel/light/both_punctual_light.h"
#include "luxel/light/both_triangle_light.h"
#include "luxel/light/device/shaders/test_formulas.comp.h"
#include "luxel/light/device/test_support_shared.h"
#include "luxel/light/surroundings.h"

namespace luxel::light {
namespace {

constexpr uint32_t kInputs = 100'000;

using on_device::Answer, on_device::FormulaPush, on_device::Question;

/// Triangles of all sizes about places in a cube of 2 m, some of them below the horizon.
std::vector<Question> questions() {
  RandomStream random{7};
  const auto anywhere = [&] { return Vec3{random.next(), random.next(), random.next()} * 2.0f; };
  const auto direction = [&] { return uniform_sphere_sample(random.next2()); };
  std::vector<Question> out;
  for (uint32_t i = 0; i < kInputs; ++i) {
    Question q{};
    const float size = std::exp2(-8 * random.next());
    q.a = anywhere(), q.b = q.a + direction() * size, q.c = q.a + direction() * size;
    q.light_normal = normalize(cross(q.b - q.a, q.c - q.a));
    q.position = anywhere(), q.normal = direction();
    q.geometric_normal = normalize(q.normal + direction() * 0.3f);
    q.direction = direction(), q.u = random.next2();
    q.angle = 2 * kPi * (2 * random.next() - 1), q.distance_m = 0.1f + 4 * random.next();
    out.push_back(q);
  }
  return out;
}

Answer answer_to(const Question& q) {
  const both::LightTriangle light{
      q.a, q.b, q.c, q.light_normal, 0.5f * length(cross(q.b - q.a, q.c - q.a)), true};
  const auto spherical = both::spherical_triangle(q.position, q.a, q.b, q.c);
  const auto by_angle = both::point_by_angle(light, spherical, q.position, q.normal, q.u);
  const auto by_area = both::point_by_area(light, q.position, q.normal, q.u);
  const both::LightGroup group{q.a, q.u.x, 2, q.light_normal, 0.1f, q.light_normal, 0.6f, 0.8f, 5};
  return {
      .by_angle = by_angle.target,
      .by_area = by_area.target,
      .column = both::direction_in_column(64, 0.3f, int(q.u.x * 64), q.u.y, double(q.direction.y)),
      .at = by_angle.at,
      .angle = both::cos_and_sin(q.angle),
      .irradiance = both::irradiance_per_radiance(light, q.position, q.normal),
      .weight_by_angle = by_angle.weight,
      .measure_by_angle = by_angle.measure,
      .weight_by_area = by_area.weight,
      .importance = both::importance_of(group, q.position, q.normal),
      .at_distance = both::share_at_distance(q.distance_m, 3),
      .in_cone = both::share_in_cone(q.direction.y, 0.8f, 0.5f),
      .folded = both::folded_cosine(q.direction, q.normal, q.geometric_normal),
      .arc_tangent = both::arc_tangent(q.direction.x, q.direction.y),
      .in_disc = both::direction_in_disc(0.1f, q.u, both::unit_circle(q.u.x)),
      .factor = both::point_to_triangle(q.position, q.normal, q.a, q.b, q.c)};
}

class Formulas : public gpu::testing::OnDevice {
 protected:
  std::vector<Answer> answers_of_device(const std::vector<Question>& questions) {
    std::vector<Answer> out(questions.size());
    auto from = gpu::buffer_with(*device_, std::as_bytes(std::span(questions)), "questions");
    auto to =
        gpu::make_buffer(*device_, out.size() * sizeof(Answer), gpu::Access::to_host, "answers");
    const FormulaPush push{from->address, to->address, uint32_t(questions.size())};
    const auto pipeline =
        gpu::make_compute_pipeline(*device_, test_formulas_comp, {sizeof(FormulaPush), {}});
    EXPECT_TRUE(pipeline) << pipeline.error().message;
    EXPECT_TRUE(commands_->run([&](VkCommandBuffer c) {
      gpu::bind(*device_, c, *pipeline, push);
      device_->vk.vkCmdDispatch(c, (push.count + 63) / 64, 1, 1);
      gpu::full_barrier(*device_, c);
    }));
    std::memcpy(out.data(), to->mapped, to->size);
    return out;
  }
};

/// The largest difference, and the share of inputs that differ by more than a tolerance.
struct Difference {
  double largest = 0;
  size_t beyond = 0;

  void add(double difference, double tolerance) {
    if (!(difference <= largest)) largest = difference;
    beyond += !(difference <= tolerance);
  }
};

double between(Vec3 a, Vec3 b) { return double(length(a - b)); }

TEST_F(Formulas, AreTheSameOnBoth) {
  if (!device_->has_doubles) GTEST_SKIP() << "the device has no double precision";
  const std::vector<Question> all = questions();
  const std::vector<Answer> found = answers_of_device(all);
  Difference factor, irradiance, angle, arc, by_area, weight_by_area, at_distance, in_cone, folded,
      in_disc, column, importance, by_angle, measure;
  for (size_t i = 0; i < all.size(); ++i) {
    const Answer &f = found[i], e = answer_to(all[i]);
    // Double precision: what rounding leaves of it, and the edges that reach the horizon.
    factor.add(std::abs(f.factor - e.factor), 1e-12);
    irradiance.add(double(std::abs(f.irradiance - e.irradiance)), 1e-6 * double(e.irradiance));
    // Series that end at 2.5e-8, and a rounding of 1e-7 of angles up to 2 pi; both_angle.h says
    // 4e-7 of arc_tangent().
    angle.add(double(length(f.angle - e.angle)), 3e-7);
    arc.add(double(std::abs(f.arc_tangent - e.arc_tangent)), 6e-7);
    // Some roundings of numbers up to 4 m.
    by_area.add(between(f.by_area, e.by_area), 1e-6);
    weight_by_area.add(double(std::abs(f.weight_by_area - e.weight_by_area)),
                       1e-5 * double(e.weight_by_area) + 1e-5);
    at_distance.add(double(std::abs(f.at_distance - e.at_distance)), 1e-5);
    in_cone.add(double(std::abs(f.in_cone - e.in_cone)), 1e-5);
    folded.add(double(std::abs(f.folded - e.folded)), 1e-6);
    in_disc.add(between(f.in_disc, e.in_disc), 1e-6);
    column.add(between(f.column, e.column), 2e-6);
    importance.add(double(std::abs(f.importance - e.importance)),
                   1e-5 * double(e.importance) + 1e-6);
    // Directions within a spherical triangle: its angle is known to 4e-7, which moves a point of a
    // small one by that over its solid angle. Those below a thousandth are sampled by area.
    if (e.measure_by_angle < 1e-3f) continue;
    measure.add(double(std::abs(f.measure_by_angle - e.measure_by_angle)), 4e-6);
    const Vec3 to_found = normalize(f.by_angle - all[i].position),
               to_expected = normalize(e.by_angle - all[i].position);
    by_angle.add(between(to_found, to_expected), 2e-3);
  }
  // Right at a threshold rounding decides: in the light's plane, or between the two cones.
  constexpr size_t kAtThreshold = 5;
  EXPECT_LE(factor.beyond, kAtThreshold) << factor.largest;
  EXPECT_LE(irradiance.beyond, kAtThreshold) << irradiance.largest;
  EXPECT_EQ(angle.beyond, 0u) << angle.largest;
  EXPECT_EQ(arc.beyond, 0u) << arc.largest;
  EXPECT_EQ(by_area.beyond, 0u) << by_area.largest;
  EXPECT_LE(weight_by_area.beyond, kAtThreshold) << weight_by_area.largest;
  EXPECT_EQ(at_distance.beyond, 0u) << at_distance.largest;
  EXPECT_EQ(in_cone.beyond, 0u) << in_cone.largest;
  EXPECT_EQ(folded.beyond, 0u) << folded.largest;
  EXPECT_EQ(in_disc.beyond, 0u) << in_disc.largest;
  EXPECT_EQ(column.beyond, 0u) << column.largest;
  EXPECT_LE(importance.beyond, kAtThreshold) << importance.largest;
  EXPECT_EQ(measure.beyond, 0u) << measure.largest;
  EXPECT_LE(by_angle.beyond, 20u) << by_angle.largest;
}

}  // namespace
}  // namespace luxel::light
