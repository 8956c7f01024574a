// One whole solution of a box.
#include "bench/hemicube.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {

Result<BoxRun> run_box(std::string test, const scene::Scene& scene, float element_size_m,
                       int hemicube, int passes, Progress& progress, hemicube::LookDevice* device) {
  BoxRun run;
  run.test = std::move(test), run.scene = scene.name;
  run.hemicube = hemicube, run.passes = passes;
  const auto start = Clock::now();
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  hemicube::HemicubeParams params;
  params.resolution = hemicube;
  params.element_size_m = element_size_m;
  params.max_error = 0;
  params.bounces = passes;
  params.device = device;
  LUXEL_TRY(const hemicube::Solution solution,
            hemicube::solve(scene, light::collect_lights(scene), tracer, params, progress));
  run.seconds = seconds_since(start);
  run.vertices = solution.field.receivers.size();
  run.triangles = solution.field.mesh.triangle_count;
  run.look = solution.seconds;
  run.row_bytes = solution.row_bytes;
  for (const Rgb& e : solution.field.irradiance)
    run.mean_irradiance += double(luminance(e)) / double(run.vertices);
  return run;
}

}  // namespace luxel::bench
