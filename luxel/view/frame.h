// Content of a picture in the viewer.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "luxel/display/tone_map.h"
#include "luxel/scene/scene.h"
#include "luxel/view/mark.h"
#include "luxel/view/technique.h"

namespace luxel::view {

/// Aspect of surfaces that is shown.
enum class Show : uint32_t {
  light_and_colour,  ///< what they send to the eye
  light,             ///< as if all surfaces were white
  colour,            ///< their reflectance, whatever falls on them
  // Parts of a bake: luxel/view/model/look.h.
  irradiance,  ///< the light that falls on them, in false colours
  checker,     ///< the lightmap's texels as squares, lit
  density,     ///< texels per metre, in false colours
  charts,      ///< the lightmap's charts, each in a colour
  seams,       ///< edges along which the lightmap is cut
  overlaps,    ///< places of the lightmap that several surfaces share, red
  texels,      ///< texels.png
  error,       ///< error.png
};

/// Words for a Show: its name in files that are played, the key that asks for it, and a
/// description. In the order of Show.
struct ShowName {
  const char *name, *key, *words;
};
inline constexpr std::array<ShowName, 11> kShows{{
    {"both", "1", "light and colour"},
    {"light", "2", "light only"},
    {"colour", "3", "colour only"},
    {"irradiance", "4", "irradiance in false colours"},
    {"checker", "5", "texels as squares"},
    {"density", "6", "density of texels"},
    {"charts", "7", "charts of the lightmap"},
    {"seams", "8", "seams of the lightmap"},
    {"overlaps", "9", "overlaps in the lightmap"},
    {"texels", "", "how texels were treated"},
    {"error", "", "standard error of texels"},
}};

/// True: it shows a bake and not the scene.
inline bool looks_into_bake(Show show) { return show >= Show::irradiance; }

/// Channel of light that becomes a false colour.
enum class Channel : uint32_t { red, green, blue, luminance };
inline constexpr std::array<const char*, 4> kChannels{"red", "green", "blue", "luminance"};

/// Part of the light that is shown, by its reflections since it left its lamp.
struct LightShown {
  uint32_t fewest = 0;           ///< reflections that it has behind it
  std::optional<uint32_t> most;  ///< none: any number
  bool is_all() const { return fewest == 0 && !most; }
  friend bool operator==(const LightShown&, const LightShown&) = default;
};
/// Parts that have a name: in files that are played, and words for them.
struct PartName {
  const char *name, *words;
  LightShown light;
};
inline constexpr std::array<PartName, 3> kParts{{
    {"all", "all light", {}},
    {"direct", "direct", {0, 0}},
    {"indirect", "indirect", {1, std::nullopt}},
}};
/// Light of more reflections is not told apart.
inline constexpr uint32_t kMostBounces = 8;

/// False colours from `low` to `high`, by the value or its logarithm.
struct ColorScale {
  float low = 0, high = 0;  ///< high <= low: that of the bake (Look)
  bool is_logarithmic = false;
  friend bool operator==(const ColorScale&, const ColorScale&) = default;
};

/// Ways to show a second bake beside the first.
enum class BesideMode : uint32_t { split, difference, flip };
inline constexpr std::array<const char*, 3> kBesideModes{"split", "difference", "flip"};
struct Beside {
  BesideMode mode = BesideMode::split;
  float split = 0.5f;  ///< where the second begins, over the picture's width
};
/// The relative difference of luminance that has the last of the false colours.
inline constexpr float kMostDifference = 0.2f;

/// Change of a layer's light since it was baked.
struct LayerSetting {
  std::string name;
  float dimmer = 1;    ///< factor of it
  Rgb color{1, 1, 1};  ///< and of each channel
  friend bool operator==(const LayerSetting&, const LayerSetting&) = default;
};

/// A line around surfaces, seen through what stands before them.
struct Outline {
  std::optional<uint32_t> instance;  ///< of the scene that is drawn; none: all
  std::vector<uint32_t> materials;   ///< of the scene that is drawn; empty: all
  Rgb color{1, 0.62f, 0.1f};         ///< display value
};

/// One picture.
struct Frame {
  scene::Camera camera;
  float exposure = 1;  ///< factor of the radiance before the curve
  display::ToneMap curve = display::ToneMap::shoulder;
  Show show = Show::light_and_colour;
  Channel channel = Channel::luminance;  ///< of Show::irradiance
  ColorScale irradiance;                 ///< E [unit of the scene's light]
  ColorScale density;                    ///< [1/m]
  std::vector<LayerSetting> layers;      ///< those that are not as they were baked
  LightShown light;                      ///< where its parts are known
  bool shows_probes = false;             ///< as balls, where there are any
  std::optional<Beside> beside;          ///< where there is a second bake
  std::optional<Outline> outline;        ///< around what is selected
  std::vector<Mark> marks;               ///< over the picture, the last one uppermost
  std::optional<Technique> technique;    ///< of Additions::techniques, where there are any
};

}  // namespace luxel::view
