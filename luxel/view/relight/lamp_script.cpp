#include "luxel/view/relight/lamp_script.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/file.h"
#include "luxel/view/model/projection.h"

namespace luxel::view {
namespace {

pipeline::Track held_at(Vec3 value) { return {{{0, value}}}; }

/// Sizes that a script may have [pixels].
constexpr int kMostPixels = 8192;

void see_as(const Walk& walk, pipeline::LightScript& script) {
  script.width = std::clamp(walk.width, 1, kMostPixels);
  script.height = std::clamp(walk.height, 1, kMostPixels);
  script.exposure.automatic = false;
  script.exposure.stops = std::log2(double(walk.shown.exposure));
  const scene::Camera& camera = walk.shown.camera;
  if (camera.orthographic_height_m > 0) return;
  const Mat34& at = camera.world_from_camera;
  const Vec3 eye = transform_point(at, {});
  // As far as the camera is from what it turns about: a script has no more digits than floats.
  const float distance_m = std::max(length(walk.target - eye), 1e-3f * walk.bounds.diagonal());
  script.camera = pipeline::LightScript::View{eye, eye + forward_of(walk) * distance_m,
                                              double(camera.fov_y_rad) * 180 / double(kPi)};
}

}  // namespace

pipeline::LightScript script_of(const Lamps& now, const Lamps& baked, const Walk& walk) {
  pipeline::LightScript out;
  out.frames = 1;
  see_as(walk, out);
  for (const scene::PunctualLight& light : shining(now))
    out.lights.push_back(
        {light, held_at(light.intensity), held_at(light.position), held_at(light.direction)});
  const std::vector<Rgb> is = glowing(now), was = glowing(baked);
  for (size_t m = 0; m < is.size(); ++m)
    if (is[m] != was[m]) out.glows.push_back({now.glows[m].name, held_at(is[m])});
  if (now.background != baked.background) out.background = held_at(now.background);
  return out;
}

std::filesystem::path script_beside(const std::filesystem::path& lxr) {
  return lxr.parent_path() / (lxr.stem().string() + "-lamps.json");
}

Result<std::string> write_lamps(const std::filesystem::path& lxr,
                                const pipeline::LightScript& script, DVec3 origin) {
  const std::filesystem::path file = script_beside(lxr);
  const std::string text = pipeline::text_of(script, origin);
  LUXEL_TRY_STATUS(write_file_atomically(file, std::as_bytes(std::span(text))));
  return fmt::format("wrote {}; `luxel relight --play {} --script {} -o FOLDER` draws it",
                     file.string(), lxr.string(), file.string());
}

}  // namespace luxel::view
