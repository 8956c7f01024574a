// Walking about in a scene: events in, camera and exposure out.
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "luxel/trace/ray_tracer.h"
#include "luxel/view/frame.h"
#include "luxel/view/model/bookmarks.h"
#include "luxel/view/model/events.h"

namespace luxel::view {

/// The place of the surface that is seen at a pixel; none where there is none.
using PlaceSeen = std::function<std::optional<Vec3>(const Frame& frame, Vec2 pixel)>;

/// The surface that is seen at a pixel of a picture of this size, by a ray from the eye; none where
/// there is none.
std::optional<scene::SurfacePoint> surface_seen(const scene::Scene& scene,
                                                const trace::RayTracer& tracer, const Frame& frame,
                                                Vec2 pixel, int width, int height);
/// By a ray from the eye; for pictures of this size. Scene and tracer must outlive it.
PlaceSeen place_seen_in(const scene::Scene& scene, const trace::RayTracer& tracer, int width,
                        int height);

/// Requests of a user besides looking.
enum class Command : uint8_t { stop_or_go_on, save, save_scene };

/// The frame that is shown, and what the user is about to do.
struct Walk {
  Frame shown;
  Frame first;      ///< what it began with
  Box3 bounds;      ///< of the scene [m]
  DVec3 origin{};   ///< scene::Scene::origin
  Box3 selected{};  ///< what is selected of it, which F shows; empty: nothing
  int width = 960, height = 720;

  Vec3 target{};  ///< what the camera turns about
  Vec2 pointer{};
  std::optional<Button> dragging;
  bool drags_line = false;     ///< between two bakes, not the camera
  std::set<std::string> keys;  ///< that are down
  bool turns = false;          ///< the camera goes round the target
  Bookmarks bookmarks;
  /// Requests by keys that are not the walk's to do; whoever does one takes it out.
  std::vector<Command> asked;
};

/// Begins with a frame. The target lies in the middle of the picture, or as far away as the scene.
Walk begin_walk(const Frame& first, const Box3& bounds, int width, int height,
                const PlaceSeen& place_seen);

/// Does at once what an event asks for. Dragging turns the camera about the place that was under
/// the pointer; with the middle or right button, or with shift, it moves the picture with the
/// pointer. The wheel goes towards the place under the pointer.
void handle(const Event& event, const PlaceSeen& place_seen, Walk& walk);

/// Flies while keys are down, a fifth of the scene's size per second. A walk that turns comes round
/// once in kTurn_s.
void pass(double seconds, Walk& walk);
inline constexpr double kTurn_s = 20;

/// The camera of the k-th of `count` pictures of a turn that begins with the walk's own.
scene::Camera turned_camera(const Walk& walk, int k, int count);

}  // namespace luxel::view
