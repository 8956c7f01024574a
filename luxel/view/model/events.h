// A user's actions at the window, as data: from the window itself, or from a file that is played.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/base/vec_double.h"
#include "luxel/pipeline/settings/sky_setting.h"
#include "luxel/scene/scene.h"
#include "luxel/view/frame.h"
#include "luxel/view/model/tools.h"

namespace luxel::view {

enum class Button : uint8_t { left, middle, right };

/// Places are pixels of the picture, (0, 0) its top left corner.
struct PointerMoved {
  Vec2 to;
};
struct ButtonChanged {
  Button button = Button::left;
  bool is_down = false;
};
struct Scrolled {
  float by = 0;  ///< notches of a wheel, away from the user > 0
};
/// A key by the letter or the name that kKeys has for it.
struct KeyChanged {
  std::string key;
  bool is_down = false;
};
/// Something else is shown, by its name in kShows.
struct ShowChanged {
  Show show = Show::light_and_colour;
};
/// False colours of what is shown run over this range; high <= low: that of the bake.
struct RangeChanged {
  ColorScale scale;
};
/// False colours of the irradiance are those of a channel, by its name in kChannels.
struct ChannelChanged {
  Channel channel = Channel::luminance;
};
/// A layer of the light is dimmed or coloured.
struct LayerChanged {
  LayerSetting setting;
};
/// A second bake is shown in another way; where none is shown, nothing changes.
struct BesideChanged {
  BesideMode mode = BesideMode::split;
};
/// The line between the two is moved, to a share of the picture's width.
struct SplitMoved {
  float to = 0.5f;
};
/// A sky as `--sky` has it.
struct SkyAsked {
  pipeline::SkySetting setting;
  std::string words;
};
/// Changes to a lamp; the rest stays.
struct LampChange {
  std::optional<DVec3> to;        ///< place in the world of the file [m]
  std::optional<Vec3> direction;  ///< in which its light travels; not 0
  std::optional<Rgb> intensity;   ///< scene::PunctualLight::intensity
  std::optional<bool> is_on;
  std::optional<float> cone_deg, inner_cone_deg;  ///< of spots: half the angle of their light
  std::optional<float> disc_deg;                  ///< of suns: the angle of their disc
  std::optional<SkyAsked> sky;  ///< of a sun, besides its direction: the sky that has it there
};
/// A lamp of an .lxr file, by its number.
struct LampChanged {
  uint32_t lamp = 0;
  LampChange change;
};
/// One lamp more, white and of 1 W/sr or W/m^2 where nothing else is said.
struct LampAdded {
  scene::PunctualLight::Kind kind = scene::PunctualLight::Kind::point;
  LampChange change;
};
/// The materials of this name glow otherwise [W/(sr m^2)].
struct GlowChanged {
  std::string material;
  Rgb radiance{};
};
/// A solver that is looked into shows its light in another way, by its own name for it (kOwnShows).
struct OwnShown {
  std::string name;
};
/// An overlay of such a solver goes on or off, by its name.
struct OverlayChanged {
  std::string name;
  bool is_on = true;
};
/// A number of such a solver.
struct SettingChanged {
  std::string name;
  double to = 0;
};
/// A command to such a solver, by its name.
struct OwnAsked {
  std::string name;
};
/// OwnAsked that ends what is under way.
inline constexpr const char* kStopAsk = "stop";
/// Names that OwnShown can have, of all solvers that can be looked into.
inline constexpr std::array<const char*, 16> kOwnShows{
    "flat",      "gouraud",    "gouraud-disc", "interpolant",
    "rayshade",  // hierarchical
    "c",         "ca",         "cad",          "cas",
    "cads",  // kTechniques
    "cas-pixel", "cads-pixel", "normals",      "radiosity-vertex",
    "radiosity", "elements"};
/// A part of the light is shown.
struct PartChanged {
  LightShown light;
};
/// Probes are shown as balls, or not.
struct ProbesChanged {
  bool are_shown = true;
};
/// Another file or folder takes the place of what is shown, as if it had been dropped.
struct OpenAsked {
  std::filesystem::path path;
};
/// The window comes to a monitor with so many pixels per point.
struct ScaleChanged {
  float to = 1;
};
/// The user closes the window, whatever goes on.
struct WindowClosed {};
/// The device is lost from here on, as after a crash of its driver: for tests.
struct DeviceLost {};
// Edits of a scene.
/// The surfaces of this name, or of this number where the name is a number; empty: none.
struct InstanceSelected {
  std::string instance;
};
struct LampSelected {
  uint32_t lamp = 0;
};
struct MaterialSelected {
  std::string material;
};
/// It stands otherwise; what is not said stays.
struct InstanceChanged {
  std::string instance;            ///< as InstanceSelected has it
  std::optional<DVec3> to;         ///< where its middle is in the world of the file [m]
  std::optional<Vec3> angles_deg;  ///< Placement::angles_deg
  std::optional<Vec3> scale;
};
struct LampRemoved {
  uint32_t lamp = 0;
};
/// The materials of this name look otherwise.
struct MaterialChanged {
  std::string material;
  std::optional<Rgb> base_color, radiance;  ///< [1], [W/(sr m^2)]
  std::optional<float> metallic;            ///< 0 to 1
};
/// A play stands still here: what comes after it is played when the bake has ended and its light is
/// shown.
struct WaitForBake {};
using Event = std::variant<PointerMoved, ButtonChanged, Scrolled, KeyChanged, LampChanged,
                           LampAdded, GlowChanged, ShowChanged, RangeChanged, ChannelChanged,
                           LayerChanged, BesideChanged, SplitMoved, InstanceSelected, LampSelected,
                           MaterialSelected, InstanceChanged, LampRemoved, MaterialChanged,
                           OwnShown, OverlayChanged, SettingChanged, OwnAsked, ToolChanged,
                           ToolUsed, SelectionStepped, GraphChanged, PartChanged, ProbesChanged,
                           OpenAsked, ScaleChanged, WindowClosed, DeviceLost, WaitForBake>;

/// True for events that change lamps or what glows; edits_scene() for other edits of a scene.
bool changes_lamps(const Event& event);
bool edits_scene(const Event& event);

/// A key and what it does, as F1 and the documentation list it.
struct KeyHelp {
  const char* key;
  const char* does;
};
inline constexpr KeyHelp kKeys[] = {
    {"w", "fly forward"},
    {"s", "fly back"},
    {"a", "fly to the left"},
    {"d", "fly to the right"},
    {"e", "fly up"},
    {"q", "fly down"},
    {"shift", "fly four times as fast; pan instead of turning"},
    {"f", "frame the selection, or the whole scene"},
    {"home", "reset the view"},
    {"o", "orbit around the point looked at, or stop"},
    {"1", "light and colour"},
    {"2", "light only"},
    {"3", "colour only"},
    {"4", "irradiance in false colours"},
    {"5", "texels as squares"},
    {"6", "density of texels"},
    {"7", "charts of the lightmap"},
    {"8", "seams of the lightmap"},
    {"9", "overlaps in the lightmap"},
    {"i", "switch between all, direct and indirect light"},
    {",", "show one bounce less"},
    {".", "show one bounce more"},
    {"b", "show or hide probes as balls"},
    {"+", "half a stop brighter"},
    {"-", "half a stop darker"},
    {"0", "reset the exposure"},
    {"ctrl+1", "save this view as bookmark 1; up to ctrl+9"},
    {"alt+1", "go to bookmark 1; up to alt+9"},
    {"space", "pause or continue the bake"},
    {"ctrl+s", "save the bake, or the moved lamps"},
};
/// Those of .lxr files.
inline constexpr KeyHelp kLampKeys[] = {
    {"x", "move a lamp along x only, or freely again"},
    {"y", "along y only"},
    {"z", "along z only"},
    {"m", "show or hide the marks of lamps"},
    {"c", "compare the light with the path tracer's, or stop"},
    {"ctrl+shift+s", "save another .lxr file with the lamps as they are"},
};

/// Those of the workshop of hemicube radiosity, besides the keys of kTechniques.
inline constexpr KeyHelp kHemicubeKeys[] = {
    {"r", "radiosity per pixel"},
    {"t", "triangles of the mesh in colours"},
    {"i", "switch what a vertex sees: triangles in colours, light, nothing"},
};
/// Those of hierarchical solutions.
inline constexpr KeyHelp kSelectionKeys[] = {
    {"p", "select the parent of the selected element"},
    {"c", "select its child at the place of the click"},
    {"n", "select the next weaker link"},
    {"g", "graph across what is selected"},
    {"esc", "select nothing"},
};
/// Those of scenes that are edited.
inline constexpr KeyHelp kEditKeys[] = {
    {"g", "move what is selected"},
    {"r", "turn it"},
    {"t", "scale it"},
    {"ctrl", "move, turn and scale in steps"},
    {"esc", "select nothing; let go of what is dragged"},
    {"delete", "delete the lamp that is selected"},
    {"ctrl+z", "undo"},
    {"ctrl+shift+z", "redo; ctrl+y, too"},
    {"ctrl+y", "redo"},
    {"ctrl+shift+s", "save the edited scene as glTF"},
    {"l", "relight: prepare lamps that move with all bounces of their light, or stop"},
    {"m", "show or hide the marks of lamps"},
};

struct TimedEvent {
  double at_s = 0;  ///< since the beginning
  Event event;
};

/// Events to play, in the order of their times, and the end.
struct Play {
  std::vector<TimedEvent> events;
  double end_s = 0;
  double frames_per_s = 30;  ///< time goes on in steps of this, whatever a frame takes
};

/// A file of events:
///
///     {"frames_per_s": 30, "end": 2.0, "events": [
///       {"at": 0, "pointer": [480, 360]}, {"at": 0, "press": "left"},
///       {"at": 1, "pointer": [600, 360]}, {"at": 1, "release": "left"},
///       {"at": 1.2, "scroll": 3}, {"at": 1.5, "key": "w"}, {"at": 1.8, "key_up": "w"},
///       {"at": 1.9, "show": "irradiance"}, {"at": 1.9, "range": [0, 500]},
///       {"at": 1.9, "channel": "red"},
///       {"at": 2, "layer": {"name": "lamp", "dimmer": 0.5, "color": [1, 0.6, 0.3]}},
///       {"at": 2, "beside": "difference"}, {"at": 2, "split": 0.3},
///       {"at": 2, "part": "direct"}, {"at": 2, "bounces": 3}, {"at": 2, "probes": true},
///       {"at": 2, "show": "interpolant"}, {"at": 2, "overlay": {"mesh": true}},
///       {"at": 2, "set": {"eps": 0.5}}, {"at": 2, "do": "iterate"},
///       {"at": 2, "tool": "link"}, {"at": 2, "use": "element", "pixel": [480, 360]},
///       {"at": 2, "use": "graph", "place": [0, 0, 0], "to_place": [1, 0, 0]},
///       {"at": 2, "selection": "up"}, {"at": 2, "graph": {"exact": false, "height": 0.5}},
///       {"at": 2, "wait": "bake"},
///       {"at": 2, "lamp": 0, "to": [1, 2, 0], "intensity": [3, 2, 1]},
///       {"at": 2, "select": "chair"}, {"at": 2, "instance": "chair", "angles_deg": [0, 90, 0]},
///       {"at": 2, "material": "wood", "reflectance": [0.5, 0.4, 0.3]}]}
///
/// A range is by the logarithm where "logarithmic_range" says so.
/// Errors: no JSON, something else in it, times that go back; each with the event's number.
Result<Play> parse_play(std::string_view text, const std::string& name);

/// Errors: a play asks for the inside of a solver; `name` is what messages call it.
Status check_no_inside(const Play& play, const std::string& name);

/// Errors: those of files, too.
Result<Play> read_play(const std::filesystem::path& file);

}  // namespace luxel::view
