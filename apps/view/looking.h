// A window looks into a bake: what it needs to draw that, and what its panel says.
#pragma once

#include <optional>

#include "apps/view/ui_look.h"
#include "luxel/view/draw/painter.h"
#include "luxel/view/model/look.h"
#include "luxel/view/model/walk.h"
#include "luxel/view/open_bake.h"

namespace luxel::view_window {

/// Made when it is first asked for.
struct Looking {
  std::optional<view::Look> look;
  std::optional<view::Overlay> overlay;
};

/// Makes what a frame needs, once. Takes about a second for a million triangles. What does not work
/// is said in `message`, and the frame then shows light and colour.
void prepare_look(const view::OpenedBake& bake, gpu::Commands& commands,
                  const view::Shaders& shaders, const view::DeviceScene& scene, view::Frame& frame,
                  Looking& looking, std::string& message);

/// What the panel says of a frame. `pointed`: the surface under the pointer.
void fill_panel(const view::Frame& frame, const view::OpenedBake& bake, const Looking& looking,
                const std::optional<scene::SurfacePoint>& pointed, LookPanel& panel);
/// What the user has changed in it, since `before`.
void take_panel(const LookPanel& panel, const LookPanel& before, view::Frame& frame);

}  // namespace luxel::view_window
