#include "luxel/solve/gather/trace/scene_of_rays.h"

namespace luxel::gather {

SceneOfRays::SceneOfRays(const TraceScene& in, const TraceParams& params) {
  if (params.follows_near) {
    widths_ = texel_widths_m(in.scene, in.atlas);
    near_.emplace(NearScene{in.scene, in.atlas, in.lights, in.tracer, widths_,
                            params.followed_layers ? params.followed_layers : params.layers,
                            in.sides});
  }
  rays_.emplace(RayScene{in.scene, in.atlas, in.lights.around, near_ ? &*near_ : nullptr,
                         params.layers, params.earlier ? params.earlier->sent : nullptr,
                         params.seed, in.sides});
}

}  // namespace luxel::gather
