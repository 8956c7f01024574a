// A window looks into a bake: what it needs to draw that, and what its panel says.
#pragma once

#include <optional>

#include "apps/view/ui_look.h"
#include "luxel/view/draw/painter.h"
#include "luxel/view/draw/put_layers.h"
#include "luxel/view/model/look.h"
#include "luxel/view/model/walk.h"
#include "luxel/view/open_bake.h"

namespace luxel::view_window {

/// Made when it is first asked for.
struct Looking {
  std::optional<view::Look> look;
  std::optional<view::Overlay> overlay;
  std::optional<view::Layers> layers;
  std::vector<view::LayerSetting> put;  ///< what of them the scene shows
  pipeline::LightmapPages mixed;        ///< the light that it shows; none while that is the bake's
};

/// Makes what a frame needs, once. Takes about a second for a million triangles. What does not work
/// is said in `message`, and the frame then shows light and colour.
void prepare_look(const view::OpenedBake& bake, gpu::Commands& commands,
                  const view::Shaders& shaders, const view::DeviceScene& scene, view::Frame& frame,
                  Looking& looking, std::string& message);

/// Puts the layers of a frame into its scene where they are others than those that it shows, or the
/// panel asks for them. What does not work is said in `message`, and the frame then has none.
void prepare_layers(const view::OpenedBake& bake, gpu::Commands& commands, bool is_asked_for,
                    view::Frame& frame, view::DeviceScene& scene, Looking& looking,
                    std::string& message);

/// What the panel says of a frame. `pointed`: the surface under the pointer.
void fill_panel(const view::Frame& frame, const view::OpenedBake& bake, const Looking& looking,
                const std::optional<scene::SurfacePoint>& pointed, LookPanel& panel);
/// What the user has changed in it, since `before`.
void take_panel(const LookPanel& panel, const LookPanel& before, view::Frame& frame);

}  // namespace luxel::view_window
