#include "luxel/view/model/walk.h"

#include <algorithm>
#include <cmath>

#include "luxel/trace/camera_rays.h"
#include "luxel/view/model/camera_moves.h"
#include "luxel/view/model/layers.h"

namespace luxel::view {
namespace {

constexpr float kTurnPerHeight = 2 * kPi;  ///< of a drag over the picture's height
constexpr float kNearerPerNotch = 0.9f;
constexpr float kSceneSizesPerSecond = 0.2f;
constexpr float kFast = 4;
constexpr float kNearLine = 6;  ///< so near is the pointer on the line [pixels]
constexpr float kHalfStop = 1.41421356f;

float aspect_of(const Walk& walk) { return float(walk.width) / float(walk.height); }

/// The place under a pixel; where there is none, the point at the target's distance.
Vec3 place_at(const Walk& walk, Vec2 pixel, const PlaceSeen& place_seen) {
  if (const auto place = place_seen(walk.shown, pixel)) return *place;
  const trace::CameraRays rays(walk.shown.camera, walk.width, walk.height);
  const trace::Ray ray = rays.through(pixel.x, pixel.y);
  const float ahead = dot(walk.target - rays.eye, rays.forward);
  const float distance = ahead > 0 ? ahead : length(walk.target - rays.eye);
  return ray.origin + ray.direction * (distance / dot(ray.direction, rays.forward));
}

bool moves_picture(const Walk& walk) {
  return *walk.dragging != Button::left || walk.keys.contains("shift");
}

void drag(Vec2 by, Walk& walk) {
  const Vec2 parts = by * (1 / float(walk.height));
  scene::Camera& camera = walk.shown.camera;
  camera = moves_picture(walk)
               ? panned(camera, walk.target, parts, aspect_of(walk))
               : orbited(camera, walk.target, -parts.x * kTurnPerHeight, parts.y * kTurnPerHeight);
}

/// True: the pointer is on the line between two bakes.
bool is_on_line(const Walk& walk) {
  const auto& beside = walk.shown.beside;
  return beside && beside->mode == BesideMode::split &&
         std::abs(walk.pointer.x - beside->split * float(walk.width)) <= kNearLine;
}

/// The next of kParts; of a part without a name, the first.
LightShown next_part(const LightShown& light) {
  for (size_t i = 0; i + 1 < kParts.size(); ++i)
    if (light == kParts[i].light) return kParts[i + 1].light;
  return kParts[0].light;
}

/// One reflection more, or less; after the last known one comes all light.
LightShown with_bounces(const LightShown& light, int by) {
  const auto most = int(light.most.value_or(kMostBounces + 1)) + by;
  if (most > int(kMostBounces)) return {};
  return {0, uint32_t(std::max(most, 0))};
}

/// Does what a key that goes down asks for. Keys that fly act in pass(), as long as they are down.
void press(const std::string& key, Walk& walk) {
  if (key == "f") {
    const Box3& box = walk.selected.empty() ? walk.bounds : walk.selected;
    walk.shown.camera = framed(walk.shown.camera, box, aspect_of(walk));
    walk.target = box.centre();
  }
  if (key == "home") walk.shown.camera = walk.first.camera;
  if (key == "o") walk.turns = !walk.turns;
  for (uint32_t i = 0; i < kShows.size(); ++i)
    if (key == kShows[i].key) walk.shown.show = Show(i);
  if (const auto mark = bookmark_key(key)) {
    auto& bookmark = walk.bookmarks[mark->number];
    if (mark->remembers)
      bookmark = bookmark_of(walk.shown, walk.first.exposure);
    else if (bookmark)
      go_to(*bookmark, walk.first.exposure, walk.shown);
  }
  if (key == "b") walk.shown.shows_probes = !walk.shown.shows_probes;
  if (key == "i") walk.shown.light = next_part(walk.shown.light);
  if (key == ",") walk.shown.light = with_bounces(walk.shown.light, -1);
  if (key == ".") walk.shown.light = with_bounces(walk.shown.light, 1);
  if (key == "space") walk.asked.push_back(Command::stop_or_go_on);
  if (key == "ctrl+s") walk.asked.push_back(Command::save);
  if (key == "ctrl+shift+s") walk.asked.push_back(Command::save_scene);
  if (key == "+") walk.shown.exposure *= kHalfStop;
  if (key == "-") walk.shown.exposure /= kHalfStop;
  if (key == "0") walk.shown.exposure = walk.first.exposure;
  // 40 stops either way show anything; beyond that floats end.
  walk.shown.exposure = std::clamp(walk.shown.exposure, walk.first.exposure * 0x1p-40f,
                                   walk.first.exposure * 0x1p40f);
}

}  // namespace

std::optional<scene::SurfacePoint> surface_seen(const scene::Scene& scene,
                                                const trace::RayTracer& tracer, const Frame& frame,
                                                Vec2 pixel, int width, int height) {
  std::array rays{trace::CameraRays(frame.camera, width, height).through(pixel.x, pixel.y)};
  const trace::Hit hit = trace::visible_hits(scene, tracer, rays).front();
  return hit.found() ? std::optional(hit.point()) : std::nullopt;
}

PlaceSeen place_seen_in(const scene::Scene& scene, const trace::RayTracer& tracer, int width,
                        int height) {
  return [&scene, &tracer, width, height](const Frame& frame, Vec2 pixel) -> std::optional<Vec3> {
    const auto point = surface_seen(scene, tracer, frame, pixel, width, height);
    return point ? std::optional(scene::world_position(scene, *point)) : std::nullopt;
  };
}

Walk begin_walk(const Frame& first, const Box3& bounds, int width, int height,
                const PlaceSeen& place_seen) {
  Walk walk;
  walk.shown = walk.first = first;
  walk.bounds = bounds;
  walk.width = width, walk.height = height;
  const Vec2 middle{0.5f * float(width), 0.5f * float(height)};
  walk.pointer = middle;
  walk.target = bounds.centre();
  walk.target = place_at(walk, middle, place_seen);
  return walk;
}

void handle(const Event& event, const PlaceSeen& place_seen, Walk& walk) {
  if (const auto* moved = std::get_if<PointerMoved>(&event)) {
    if (walk.dragging && walk.drags_line)
      walk.shown.beside->split = std::clamp(moved->to.x / float(walk.width), 0.0f, 1.0f);
    else if (walk.dragging)
      drag(moved->to - walk.pointer, walk);
    walk.pointer = moved->to;
  }
  if (const auto* changed = std::get_if<ButtonChanged>(&event)) {
    if (changed->is_down && !walk.dragging) {
      walk.dragging = changed->button;
      walk.drags_line = changed->button == Button::left && is_on_line(walk);
      walk.target = place_at(walk, walk.pointer, place_seen);
    } else if (!changed->is_down && walk.dragging == changed->button) {
      walk.dragging.reset();
    }
  }
  if (const auto* scrolled = std::get_if<Scrolled>(&event)) {
    const Vec3 place = place_at(walk, walk.pointer, place_seen);
    walk.shown.camera =
        approached(walk.shown.camera, place, std::pow(kNearerPerNotch, scrolled->by));
  }
  if (const auto* key = std::get_if<KeyChanged>(&event)) {
    if (!key->is_down) walk.keys.erase(key->key);
    if (key->is_down && walk.keys.insert(key->key).second) press(key->key, walk);
  }
  if (const auto* changed = std::get_if<ShowChanged>(&event)) walk.shown.show = changed->show;
  if (const auto* changed = std::get_if<ChannelChanged>(&event))
    walk.shown.channel = changed->channel;
  if (const auto* changed = std::get_if<BesideChanged>(&event); changed && walk.shown.beside)
    walk.shown.beside->mode = changed->mode;
  if (const auto* moved = std::get_if<SplitMoved>(&event); moved && walk.shown.beside)
    walk.shown.beside->split = moved->to;
  if (const auto* changed = std::get_if<PartChanged>(&event)) walk.shown.light = changed->light;
  if (const auto* changed = std::get_if<ProbesChanged>(&event))
    walk.shown.shows_probes = changed->are_shown;
  if (const auto* changed = std::get_if<LayerChanged>(&event))
    set_layer(changed->setting, walk.shown.layers);
  if (const auto* changed = std::get_if<RangeChanged>(&event))
    (walk.shown.show == Show::density ? walk.shown.density : walk.shown.irradiance) =
        changed->scale;
}

namespace {

/// Flies while keys are down.
void fly(double seconds, Walk& walk) {
  const auto along = [&](const char* there, const char* back) {
    return float(walk.keys.contains(there)) - float(walk.keys.contains(back));
  };
  const Vec3 direction{along("d", "a"), along("e", "q"), along("w", "s")};
  if (length(direction) == 0) return;
  const float speed =
      kSceneSizesPerSecond * walk.bounds.diagonal() * (walk.keys.contains("shift") ? kFast : 1);
  const Vec3 by = normalize(direction) * (speed * float(seconds));
  const Vec3 before = column(walk.shown.camera.world_from_camera, 3);
  walk.shown.camera = flown(walk.shown.camera, by);
  walk.target += column(walk.shown.camera.world_from_camera, 3) - before;
}

}  // namespace

void pass(double seconds, Walk& walk) {
  fly(seconds, walk);
  if (!walk.turns || walk.dragging) return;
  const auto aside = float(seconds / kTurn_s * 2 * double(kPi));
  walk.shown.camera = orbited(walk.shown.camera, walk.target, aside, 0);
}

scene::Camera turned_camera(const Walk& walk, int k, int count) {
  const auto aside = float(2 * double(kPi) * k / count);
  return orbited(walk.shown.camera, walk.target, aside, 0);
}

}  // namespace luxel::view
