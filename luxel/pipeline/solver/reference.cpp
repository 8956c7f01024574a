// The path tracer as a solver: slow, and right wherever paths reach.
#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/light/supersample.h"
#include "luxel/pipeline/solver/memory.h"
#include "luxel/pipeline/solver/on_device.h"
#include "luxel/pipeline/solver/solver.h"
#include "luxel/pipeline/solver/texel_light.h"
#include "luxel/reference/path_device.h"
#include "luxel/transport/back_faces.h"

namespace luxel::pipeline {
namespace {

/// A point of a texel's footprint, held twice while the list is made.
constexpr uint64_t kBytesPerFootprintPoint = 120;

Result<TexelLight> solve_reference(const light::TexelScene& in, const BakeSettings& settings,
                                   const SolveStores& stores, const SolveObserver&,
                                   Progress& progress) {
  const int points = std::min(first_supersample(settings), settings.samples);
  const uint64_t per_element = points > 1 ? uint64_t(points) * kBytesPerFootprintPoint : 0;
  LUXEL_TRY_STATUS(memory_to_spare(in, settings, bytes_of_light(in, settings),
                                   per_element * in.elements.size()));
  const reference::PathParams params{settings.samples, settings.bounces, settings.seed};
  light::Footprints footprints;
  reference::Receivers receivers = reference::receivers(in.elements);
  if (points > 1) {
    LUXEL_TRY(footprints, light::footprints(in, points, settings.seed, progress));
    receivers = reference::receivers(footprints.points);
    receivers.first = footprints.first;
  }
  const auto follow = [&](const BakeDevice* on) {
    LUXEL_CHECK(!on || on->paths);
    return on ? on->paths->irradiance(in.scene, in.tracer, receivers, params, progress)
              : reference::irradiance_by_paths(in.scene, receivers, in.tracer, params, progress,
                                               stores.team);
  };
  TookPart part;
  LUXEL_TRY(reference::TexelPaths result, run_on_any(stores.device, follow, part));
  result.enclosed = transport::find_enclosed(in.scene, in.tracer, in.elements, [&](size_t i) {
    return transport::BackFaces{settings.samples, int(result.met_back[i]),
                                int(result.met_double_sided_back[i])};
  });
  TexelLight out = texel_light(std::move(result));
  for (const float error : result.luminance_error) out.variance.push_back(error * error);
  out.device = std::move(part.device), out.warnings = std::move(part.warnings);
  return out;
}

/// The time of one core per path in most scenes, and to spread a point over a texel [s].
constexpr double kPathSeconds = 3.4e-6, kPointSeconds = 5e-6;

std::vector<Stage> usual_reference(const BakeSettings& settings, double texels) {
  const int points = std::min(first_supersample(settings), settings.samples);
  return {{"footprints", points > 1 ? kPointSeconds * points * texels : 0},
          {"trace paths", kPathSeconds * settings.samples * texels}};
}

}  // namespace

Solver reference_solver() {
  return {.name = "reference",
          .can = {.samples = true,
                  .supersample = true,
                  .noise = true,
                  .scatters = true,
                  .teams = true,
                  .device = true},
          .solve = solve_reference,
          .usual = usual_reference,
          .notes = {{"--samples", "paths per texel"}}};
}

}  // namespace luxel::pipeline
