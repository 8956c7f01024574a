#include "luxel/validate/prepared.h"

#include <ctime>

#include "luxel/base/check.h"
#include "luxel/pipeline/texels/two_sides.h"

namespace luxel::validate {

Result<std::unique_ptr<Prepared>> prepare(scene::Scene scene, int resolution, Progress& progress) {
  auto p = std::make_unique<Prepared>();
  p->scene = std::move(scene);
  LUXEL_TRY_STATUS(pipeline::add_outside_light({}, p->scene));
  atlas::AtlasParams params;
  params.resolution = resolution;
  LUXEL_TRY(const pipeline::Sides sides,
            pipeline::split_sides(p->scene, {.resolution = resolution}, progress));
  params.uv = sides.uv;
  LUXEL_TRY(p->atlas, atlas::make_atlas(p->scene, params, progress));
  p->map = atlas::rasterise(p->scene, p->atlas);
  p->elements = transport::elements_from_texels(p->scene, p->atlas, p->map);
  p->lights = light::collect_lights(p->scene);
  LUXEL_TRY(trace::RayTracer tracer, trace::RayTracer::build(p->scene));
  p->tracer.emplace(std::move(tracer));
  return p;
}

Result<Timed> solve(const Prepared& p, std::string_view solver, pipeline::BakeSettings settings,
                    Progress& progress) {
  const pipeline::Solver* found = pipeline::find_solver(solver);
  LUXEL_CHECK(found != nullptr);
  settings.solver = solver;
  settings.output = std::filesystem::temp_directory_path();
  settings.resolution = p.map.resolution;
  settings.supersample = 1;  // judged at points, where the judge looks too
  const auto start = Clock::now();
  const std::clock_t processors = std::clock();
  Timed out;
  LUXEL_TRY(out.light, found->solve(p.input(), settings, {}, {}, progress));
  out.seconds = seconds_since(start);
  out.processor_seconds = processor_seconds_since(processors);
  return out;
}

}  // namespace luxel::validate
