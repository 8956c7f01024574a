// A scene ready for a solver.
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "luxel/base/clock.h"
#include "luxel/pipeline/solver/solvers.h"

namespace luxel::validate {

/// Members refer to each other: it is made in place and not moved.
struct Prepared {
  scene::Scene scene;
  atlas::Atlas atlas;
  atlas::TexelMap map;
  transport::Elements elements;
  light::Lights lights;
  std::optional<trace::RayTracer> tracer;

  light::TexelScene input() const { return {scene, atlas, map, elements, lights, *tracer}; }
};

/// Lays the scene out on a lightmap of `resolution` squared. A scene without any light gets a clear
/// day. Errors: those of atlas and ray tracer, cancelled.
Result<std::unique_ptr<Prepared>> prepare(scene::Scene scene, int resolution, Progress& progress);

struct Timed {
  pipeline::TexelLight light;
  double seconds = 0;
  double processor_seconds = 0;  ///< of all threads, however busy the machine is
};
/// Runs a solver of the pipeline's table by name; settings' scene, output and resolution are not
/// looked at. Errors: those of the solver, cancelled.
Result<Timed> solve(const Prepared& p, std::string_view solver, pipeline::BakeSettings settings,
                    Progress& progress);

}  // namespace luxel::validate
