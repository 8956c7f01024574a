#include "luxel/pipeline/solver/check_settings.h"

#include "luxel/pipeline/solver/solvers.h"

namespace luxel::pipeline {

Status check(const BakeSettings& s) {
  const Solver* solver = find_solver(s.solver);
  if (!solver)
    return fail(ErrorCode::bad_setting, "--solver {} is not known; there is: {}", s.solver,
                solver_names());
  LUXEL_TRY_STATUS(check_values(s));
  if (s.denoise && !solver->noise)
    return fail(ErrorCode::bad_setting,
                "--denoise needs light with known noise, which --solver {} has not; leave it out",
                s.solver);
  if (s.layers != light::LayerMode::none && !solver->layers)
    return fail(ErrorCode::bad_setting,
                "--layers needs light that can be told apart, which --solver {} does not keep; use "
                "--solver gather",
                s.solver);
  if (s.keep && !solver->keeps)
    return fail(
        ErrorCode::bad_setting,
        "--keep needs rays that can be kept, which --solver {} has not; use --solver gather",
        s.solver);
  if (s.vertex_colors && s.solver != "hemicube")
    return fail(ErrorCode::bad_setting,
                "--vertex-colors needs light per vertex, which --solver {} does not compute; use "
                "--solver hemicube",
                s.solver);
  return {};
}

}  // namespace luxel::pipeline
