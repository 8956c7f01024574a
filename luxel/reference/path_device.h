// Path tracing on a graphics device; luxel/reference/device/ implements it. The path tracer itself
// knows no graphics.
#pragma once

#include "luxel/reference/path_tracer.h"

namespace luxel::reference {

/// Follows paths in place of the processor.
class PathDevice {
 public:
  virtual ~PathDevice() = default;

  /// irradiance_by_paths(). Errors: cancelled, something in the scene that the device does not know
  /// (ErrorCode::unsupported), no memory, the device is lost.
  virtual Result<TexelPaths> irradiance(const scene::Scene& scene, const trace::RayTracer& tracer,
                                        const Receivers& receivers, const PathParams& params,
                                        Progress& progress) = 0;

  /// radiance_by_paths(). Errors: as above.
  virtual Result<Picture> radiance(const scene::Scene& scene, const trace::RayTracer& tracer,
                                   const scene::Camera& camera, int width, int height,
                                   const PathParams& params, Progress& progress) = 0;
};

}  // namespace luxel::reference
