// Solvers whose elements are larger than the gap between two surfaces, against the path tracer.
#include <gtest/gtest.h>

#include <cstdlib>

#include "luxel/pipeline/solver/hemicube.h"
#include "luxel/pipeline/solver/matrix.h"
#include "luxel/validate/agreement.h"
#include "tests/contact_room.h"

namespace luxel::validate {
namespace {

struct Part {
  double truth = 0, solved = 0, squares = 0, count = 0, largest = 0;
  void print(const char* name, double mean) const {
    std::printf("    %-8s %6.0f texels: truth %.4f solved %.4f, bias %.2f %%, rms %.2f %%, largest %.3f\n", name, count,
                truth / count, solved / count, 100 * (solved / truth - 1),
                100 * std::sqrt(squares / count) / mean, largest);
  }
};

TEST(NearContacts, Experiment) {
  const char* names = std::getenv("SOLVERS");
  const int resolution = std::getenv("RES") ? atoi(std::getenv("RES")) : 64;
  const int patches = std::getenv("PATCHES") ? atoi(std::getenv("PATCHES")) : 2048;
  for (const test::Thin thin : {test::Thin::sheet, test::Thin::double_sided_sheet, test::Thin::box}) {
    const test::ContactRoom room = test::contact_room_with(thin);
    Progress progress;
    const auto p = prepare(room.scene, resolution, progress);
    ASSERT_TRUE(p) << p.error().message;
    const auto judged = judge(**p, 128, 1, progress);
    ASSERT_TRUE(judged);
    for (const pipeline::Solver& solver : pipeline::solvers()) {
      if (names && !std::strstr(names, std::string(solver.name).c_str())) continue;
      pipeline::BakeSettings settings;
      settings.samples = 256;
      settings.own.of<hemicube::HemicubeParams>().max_elements = 10000;
      settings.own.of<matrix::MatrixParams>().patches.count = patches;
      const auto solved = solve(**p, solver.name, settings, progress);
      ASSERT_TRUE(solved) << solved.error().message;
      Part covered, near, rest;
      size_t hidden = 0, hidden_judge=0;
      double mean = 0;
      for (size_t i = 0; i < judged->first.size(); ++i) mean += luminance(judged->mean(i)) / judged->first.size();
      for (size_t i = 0; i < judged->first.size(); ++i) {
        const Vec3 at = (*p)->elements.position[i], n = (*p)->elements.geometric_normal[i];
        hidden += solved->light.hidden[i]; hidden_judge += judged->hidden[i];
        const bool is_covered = room.is_covered(at, n, 0.005f);
        if (!is_covered && (solved->light.hidden[i] || judged->hidden[i])) continue;
        Part& part = is_covered ? covered : room.is_near(at, n, 0.15f) ? near : rest;
        const double t = luminance(judged->mean(i)), s = luminance(solved->light.irradiance[i]);
        part.truth += t, part.solved += s, part.squares += (s - t) * (s - t), part.count += 1;
        part.largest = std::max(part.largest, s);
      }
      std::printf("  %d %s: %.1f s, states %.2f %%, hidden %zu, judge %zu\n", int(thin), std::string(solver.name).c_str(), solved->seconds,
                  100 * solved->light.relative_error, hidden,hidden_judge);
      covered.print("covered", mean), near.print("near", mean), rest.print("rest", mean);
    }
  }
}

}  // namespace
}  // namespace luxel::validate
