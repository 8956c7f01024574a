// The scene that rays of elements meet, made ready for one round of them.
#pragma once

#include <optional>
#include <vector>

#include "luxel/solve/gather/trace/sort_rays.h"

namespace luxel::gather {

/// A RayScene with what it refers to. Refers to `in` and `params`, and to itself.
class SceneOfRays {
 public:
  SceneOfRays(const TraceScene& in, const TraceParams& params);
  SceneOfRays(const SceneOfRays&) = delete;
  SceneOfRays& operator=(const SceneOfRays&) = delete;

  const RayScene& rays() const { return *rays_; }

 private:
  std::vector<float> widths_;
  std::optional<NearScene> near_;
  std::optional<RayScene> rays_;
};

}  // namespace luxel::gather
