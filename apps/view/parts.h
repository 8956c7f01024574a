// A window shows a part of the light, and probes: what it needs to draw them, and what its panel
// says.
#pragma once

#include "apps/view/looking.h"
#include "apps/view/ui_parts.h"

namespace luxel::view_window {

/// Makes what a frame needs of them, once. Nothing may still draw the scene. What is not there is
/// said in an error, after which the frame shows what it can.
Status prepare_parts(gpu::Commands& commands, view::Frame& frame, view::ShownScene& shown,
                     Looking& looking);

/// Describes a frame in the panel.
PartsPanel parts_panel(const view::Frame& frame, const view::ShownScene& shown);
/// Applies the user's changes in the panel since `before`.
void take_parts(const PartsPanel& panel, const PartsPanel& before, view::Frame& frame);

}  // namespace luxel::view_window
