// Motion of lights: the file that `luxel relight --play` follows (docs/method/relight.md describes
// it).
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/base/vec_double.h"
#include "luxel/pipeline/render/exposure.h"
#include "luxel/scene/scene.h"

namespace luxel::pipeline {

/// A value that changes with time: linear between its keys, constant outside them.
struct Track {
  /// A value at a time [s].
  struct Key {
    double at_s = 0;
    Vec3 value;
  };
  std::vector<Key> keys;  ///< ascending; never empty once read
};
/// The value of a track at a time of the script [s]; `track` has a key.
Vec3 value_at(const Track& track, double time_s);

/// Punctual lights, glowing materials and a camera over time: what a light script file says.
struct LightScript {
  /// A punctual light whose intensity, position and direction have tracks.
  struct MovingLight {
    scene::PunctualLight light;  ///< what does not move
    Track intensity, position, direction;
  };
  /// A material whose emitted radiance [W/(sr m^2)] has a track.
  struct Glow {
    std::string material;
    Track radiance;
  };
  /// A camera that stands still: eye and target [m], vertical field of view.
  struct View {
    Vec3 eye, look_at;
    double fov_deg = 45;
  };
  int frames = 24;
  double frames_per_second = 24;
  int width = 640, height = 480;
  std::variant<std::monostate, std::string, View> camera;  ///< none: as luxel render chooses
  Exposure exposure;
  bool keep_lights = false;  ///< the scene's own punctual lights stay on
  std::vector<MovingLight> lights;
  std::vector<Glow> glows;
  std::optional<Track> background;  ///< none: as baked
};

/// Places in the text are those of the world of the scene's file, and become those of a scene of
/// this origin. Errors name the file, the field, its value and what it should be; unknown fields
/// are errors.
Result<LightScript> parse_light_script(const std::string& text, const std::string& name,
                                       DVec3 origin = {});

/// The file of a script for a scene of this origin: parse_light_script() gives the script again,
/// angles but for rounding.
std::string text_of(const LightScript& script, DVec3 origin = {});

/// The punctual lights of a frame.
std::vector<scene::PunctualLight> lights_at(const LightScript& script, double time_s);

}  // namespace luxel::pipeline
