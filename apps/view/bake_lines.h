// The panel's lines about a bake that is being made.
#pragma once

#include "apps/view/bake_panel.h"
#include "luxel/view/live/live_bake.h"
#include "luxel/view/shown/shown_scene.h"

namespace luxel::view_window {

BakeLines lines_of(const view::LiveBake& live, const view::ShownScene& shown);

}  // namespace luxel::view_window
