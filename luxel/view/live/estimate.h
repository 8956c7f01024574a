// Light after an edit within a fraction of a second: few rays of few texels of the layout that is
// there, before and after, and what changes from the one to the other.
#pragma once

#include <memory>

#include "luxel/base/progress.h"
#include "luxel/view/live/draft.h"
#include "luxel/view/live/few_rays.h"

namespace luxel::view {

/// So much work as one core does in about so many seconds [s], by what rays cost in such scenes and
/// not by a clock: the same edit always gets the same light. `texels`: those of the map, which take
/// their part of the time.
EstimateParams params_within(double seconds, const scene::Scene& scene, size_t texels);

/// Light of a scene in which instances stand elsewhere, lamps or materials are others than in the
/// one as it was read of which `known` is. All bounces; the same rays before and after, so that
/// what nothing has changed stays what it was. The result is laid out as `known` is and
/// has no Draft::bounced. Errors: no memory; cancelled.
Result<std::unique_ptr<Draft>> estimate_light(const KnownLight& known, const scene::Scene& edited,
                                              const EstimateParams& params,
                                              const Progress& watched);

}  // namespace luxel::view
