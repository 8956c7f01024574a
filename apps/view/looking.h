// A window looks into a bake: what it needs to draw that, and what its panel says.
#pragma once

#include <memory>
#include <optional>

#include "apps/view/ui_look.h"
#include "luxel/view/draw/painter.h"
#include "luxel/view/draw/probe_drawing.h"
#include "luxel/view/draw/put_layers.h"
#include "luxel/view/model/histogram.h"
#include "luxel/view/model/look.h"
#include "luxel/view/model/walk.h"
#include "luxel/view/shown/shown_scene.h"

namespace luxel::view_window {

/// Made when it is first asked for; of one scene.
struct Looking {
  std::optional<view::Look> look;
  std::optional<view::Overlay> overlay;
  std::optional<view::Layers> layers;
  std::vector<view::LayerSetting> put;       ///< what of them the scene shows
  std::optional<view::Histogram> histogram;  ///< of the last frame
  std::optional<view::DeviceProbes> probes;
  std::shared_ptr<const view::ProbeBalls> of_probes;  ///< what they were made of
  pipeline::LightmapPages mixed;  ///< the light that it shows; none while that is the bake's
};

/// Makes what a frame needs, once, and puts its layers into the scene. The panel's lines of layers
/// need them, too. Takes about a second for a million triangles. Nothing may still draw the scene.
/// Errors name data that the bake lacks; the frame shows the rest afterwards.
Status prepare_look(gpu::Commands& commands, const gpu::Pipeline& shader, bool needs_layers,
                    view::Frame& frame, view::ShownScene& shown, Looking& looking);

/// Canvas for a picture of a scene that is looked into. `additions` may be null.
view::Canvas canvas_of(const view::Shaders& shaders, const view::Painter& painter,
                       const view::DeviceScene& scene, const Looking& looking,
                       const view::Additions* additions = nullptr);

/// Describes a frame in the panel. `pointed`: the surface under the pointer.
void fill_panel(const view::Frame& frame, const view::ShownScene& shown, const Looking& looking,
                const std::optional<scene::SurfacePoint>& pointed, LookPanel& panel);
/// Applies the user's changes in the panel since `before`.
void take_panel(const LookPanel& panel, const LookPanel& before, view::Frame& frame);

}  // namespace luxel::view_window
