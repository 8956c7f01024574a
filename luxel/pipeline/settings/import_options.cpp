#include "luxel/pipeline/settings/import_options.h"

#include "luxel/pipeline/settings/option_rows.h"

namespace luxel::pipeline {

Options<import::ImportParams> import_options() {
  using import::ImportParams;
  return {Rows<ImportParams>::number(
              "--smooth-normals", &ImportParams::smooth_normals_deg, {0, 180},
              fmt::format("Meshes without normals: smooth across edges that bend by at most this "
                          "angle, 0: flat; by default {} for OBJ and PLY, else flat",
                          import::kUsualCreaseDeg))
              .key_is("smooth_normals_deg")
              .unit("DEG")
              .leaves(Changes::scene)};
}

}  // namespace luxel::pipeline
