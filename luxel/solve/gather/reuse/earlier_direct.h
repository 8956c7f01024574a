// Direct light of an earlier bake, brought up to date with what has changed in the scene.
#pragma once

#include "luxel/light/texel_scene.h"
#include "luxel/solve/gather/reuse/earlier.h"

namespace luxel::gather {

/// Looks at lights again in earlier.direct: at earlier.changed_lights from all elements, which adds
/// their light (not with layers); then at all lights from elements that lie elsewhere, or where
/// something in earlier.rays.boxes may be, or have been, in the light's way. Those are supersampled
/// where that light is uneven. direct.rays is the number of rays it took. Fills in
/// earlier.rays.same_light_m. Errors: cancelled.
Status update_direct(const light::TexelScene& in, const light::SupersampleParams& params,
                     Earlier& earlier, Progress& progress);

}  // namespace luxel::gather
