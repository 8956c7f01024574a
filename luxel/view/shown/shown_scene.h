// A scene on a graphics device, with its light as far as it is known.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "luxel/view/draw/device_scene.h"
#include "luxel/view/live/fade.h"
#include "luxel/view/live/live_bake.h"
#include "luxel/view/model/look.h"
#include "luxel/view/open_bake.h"

namespace luxel::view {

struct ShownScene {
  DeviceScene device;
  std::shared_ptr<const ReadScene> read;  ///< null: there is nothing to see yet
  bool has_light = false;                 ///< false: colours can be shown, nothing else
  Fade fade;
  std::array<bool, 2> is_without_lamps{};  ///< of DeviceScene::lights
  PagesOfHalves without_lamps;             ///< LiveNews::without_lamps of the newest light
  /// `newest` with lamps where it is without, and without where it is with; none: it is not known.
  PagesOfHalves otherwise;
  std::optional<LiveLight> waiting;   ///< light that comes when what was there before has faded in
  LiveNumbers numbers;                ///< of the light that came last
  bool has_last = false;              ///< all light has come
  std::vector<std::string> warnings;  ///< of the bake
  LightShown part;                    ///< of the light, that is shown
  PagesOfHalves newest;               ///< all light that came last; none: it is `lightmaps`
  std::shared_ptr<const BouncedLight> bounced;  ///< of it; null: not told apart, or not yet read
  std::shared_ptr<const ProbeBalls> probes;     ///< null: there are none, or not yet read

  /// Lightmaps that are looked into: those of a finished bake, or the first of one being made.
  pipeline::LightmapPages lightmaps;
  std::optional<LitScene> lit;   ///< of a bake that is made: what `device` draws; else read->scene
  std::filesystem::path folder;  ///< of a bake that is there
  bool has_layers = false;       ///< read_layers() finds some there

  /// The scene that `device` draws, and places of its vertices in the lightmap; empty: uv1.
  const scene::Scene& drawn() const { return lit ? lit->scene : read->scene; }
  std::span<const std::vector<Vec2>> light_uv() const {
    return lit ? std::span<const std::vector<Vec2>>(lit->light_uv)
               : std::span<const std::vector<Vec2>>();
  }
};

/// The look of a scene whose light has come. Errors: those of look_into(); it has no lightmap.
Result<Look> look_of(const ShownScene& shown);

/// A scene in which nothing can be seen, for a window that opens before the file is read.
Result<ShownScene> nothing_shown(gpu::Commands& commands);

/// A scene on a device whose light is not known.
Result<DeviceScene> colours_shown(gpu::Commands& commands, const scene::Scene& scene);

/// A bake that is there. It is used up.
Result<ShownScene> bake_shown(gpu::Commands& commands, OpenedBake bake);

/// Puts what has come on the device. True: `device` is another one than before. `said` gets what is
/// to be told. Nothing may still draw the scene. Errors: no memory on the device.
Result<bool> take_news(LiveNews news, gpu::Commands& commands, ShownScene& shown,
                       std::string& said);

/// Light fades in, and what has waited for that comes. Nothing may still draw the scene. Errors: no
/// memory on the device.
Status pass(double seconds, gpu::Commands& commands, ShownScene& shown);

/// pass(), until all light that has come is shown.
Status settle(gpu::Commands& commands, ShownScene& shown);
/// Before the light of an edit is known: shows the newest light without that of lamps, which are
/// to be drawn; where it is not known, does nothing. Nothing may still draw the scene. Errors: no
/// memory on the device.
Status leave_out_lamps(gpu::Commands& commands, ShownScene& shown);
/// After an edit: shows light without that of lamps, if they are drawn, or all light, if it is
/// looked into. Nothing may still draw the scene. Errors: no memory on the device.
Status draw_lamps_or_not(bool are_drawn, gpu::Commands& commands, ShownScene& shown);
/// Share of the lamps' direct light that is missing in what is shown.
float lamp_share(const ShownScene& shown);

/// True: all light that has come is shown.
bool is_settled(const ShownScene& shown);

}  // namespace luxel::view
