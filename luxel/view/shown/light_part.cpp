#include "luxel/view/shown/light_part.h"

namespace luxel::view {
namespace {

/// All light that came last.
std::vector<image::Image> newest_of(const ShownScene& shown) {
  if (shown.newest.empty()) return shown.lightmaps.pictures;
  std::vector<image::Image> out;
  for (const image::HalfImage& page : shown.newest) out.push_back(to_floats(page));
  return out;
}

/// Told apart: what has come with the light, or what lies beside a bake.
Status find_bounced(ShownScene& shown) {
  if (shown.bounced) return {};
  if (!shown.folder.empty()) {
    LUXEL_TRY(BouncedLight bounced, read_bounced(shown.folder, shown.lightmaps));
    shown.bounced = std::make_shared<const BouncedLight>(std::move(bounced));
    return {};
  }
  return fail(ErrorCode::bad_input, "{}",
              shown.has_light ? "the bounces of this light are not known separately; bake the "
                                "scene with --solver gather to see each of them"
                              : "there is no light yet");
}

}  // namespace

Result<std::vector<image::Image>> pages_shown(const LightShown& light, const ShownScene& shown) {
  std::vector<image::Image> all = newest_of(shown);
  if (light.is_all() || !shown.bounced) return all;
  return part_of(light, *shown.bounced, all);
}

Status show_part(const LightShown& light, gpu::Commands& commands, ShownScene& shown) {
  if (light == shown.part) return {};
  if (!light.is_all()) LUXEL_TRY_STATUS(find_bounced(shown));
  if (shown.device.lights[0] == shown.device.lights[1])
    return fail(ErrorCode::bad_input,
                "the bounces were baked after {} was opened; open it again to see them",
                shown.folder.string());
  LUXEL_TRY(const std::vector<image::Image> pages, pages_shown(light, shown));
  std::vector<image::HalfImage> halves;
  for (const image::Image& page : pages) halves.push_back(image::to_half(page));
  // A fade that is under way ends.
  const uint32_t other = 1 - shown.fade.newest;
  LUXEL_TRY_STATUS(put_light(commands, halves, other, shown.device));
  // Where lamps are left out nothing is told apart: ShownScene::bounced.
  shown.is_without_lamps[other] = false;
  shown.fade.newest = other, shown.fade.share = 1;
  shown.fade.exposure_before = shown.fade.exposure_newest;
  shown.device.second_light = second_light(shown.fade);
  shown.part = light;
  return {};
}

}  // namespace luxel::view
