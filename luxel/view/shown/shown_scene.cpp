#include "luxel/view/shown/shown_scene.h"

namespace luxel::view {
namespace {

/// Pages of one white texel, for surfaces whose light is not known.
Result<DeviceScene> without_light(gpu::Commands& commands, const scene::Scene& scene) {
  image::Image white(1, 1, 4);
  white.set_rgb(0, 0, {1, 1, 1});
  const std::vector<image::HalfImage> pages{image::to_half(white)};
  const std::vector<size_t> of_material(scene.materials.size(), 0);
  return put_on_device(commands, scene, PagesOfLight{pages, of_material}, {});
}

Result<DeviceScene> with_light(gpu::Commands& commands, const LitScene& lit,
                               const LiveLight& light) {
  DeviceSceneParams params;
  params.light_changes = true, params.light_uv = lit.light_uv;
  params.shadow_side = kShadowSide;
  return put_on_device(commands, lit.scene, PagesOfLight{light.pages, lit.page_of_material},
                       params);
}

/// The light so far, as a bake's files have it.
pipeline::LightmapPages pages_of(const LiveLight& light, const LitScene& lit) {
  pipeline::LightmapPages out;
  out.of_material = lit.page_of_material;
  for (const image::HalfImage& page : light.pages) out.pictures.push_back(to_floats(page));
  return out;
}

/// The newest light, or the part of it that is shown, becomes that of the fade's newest picture.
Status put_newest(gpu::Commands& commands, ShownScene& shown) {
  if (!shown.bounced) shown.part = {};
  if (shown.part.is_all())
    return put_light(commands, shown.newest, shown.fade.newest, shown.device);
  std::vector<image::Image> all;
  for (const image::HalfImage& page : shown.newest) all.push_back(to_floats(page));
  // Another scene may be told apart less finely.
  const auto part = part_of(shown.part, *shown.bounced, all);
  if (!part) shown.part = {};
  PagesOfHalves halves;
  for (const image::Image& page : part ? *part : all) halves.push_back(image::to_half(page));
  return put_light(commands, halves, shown.fade.newest, shown.device);
}

/// Light fades in over what is shown.
Status fade_in(LiveLight light, gpu::Commands& commands, ShownScene& shown) {
  shown.fade = faded_to_other(shown.fade, light.exposure);
  shown.device.second_light = second_light(shown.fade);
  shown.newest = std::move(light.pages), shown.otherwise = std::move(light.with_lamps);
  shown.is_without_lamps[shown.fade.newest] = light.is_without_lamps;
  return put_newest(commands, shown);
}

/// The sky of an edited scene.
Status put_other_sky(const scene::Environment& map, gpu::Commands& commands, ShownScene& shown) {
  const bool is_other =
      shown.read && !map.empty() && map.radiance != shown.read->scene.environment.radiance;
  return is_other ? set_surroundings(commands, map, shown.device) : Status();
}

/// Takes bounces, light without lamps and probes that have come.
void take_more(LiveNews& news, ShownScene& shown) {
  if (news.bounced || news.lit || news.read) shown.bounced = std::move(news.bounced);
  if (news.probes || news.read) shown.probes = std::move(news.probes);
  if (news.light || news.lit || news.read || !news.without_lamps.empty())
    shown.without_lamps = std::move(news.without_lamps);
}

}  // namespace

Result<DeviceScene> colours_shown(gpu::Commands& commands, const scene::Scene& scene) {
  return without_light(commands, scene);
}

Result<ShownScene> nothing_shown(gpu::Commands& commands) {
  scene::Scene nothing;
  scene::Mesh& mesh = nothing.meshes.emplace_back();
  mesh.positions.resize(3);
  mesh.triangles.push_back({0, 1, 2});
  mesh.triangle_material.push_back(0);
  nothing.instances.resize(1), nothing.materials.resize(1);
  ShownScene out;
  LUXEL_TRY(out.device, without_light(commands, nothing));
  return out;
}

Result<ShownScene> bake_shown(gpu::Commands& commands, OpenedBake bake) {
  ShownScene out;
  DeviceSceneParams params;
  std::error_code ignored;
  params.light_changes =
      bake.has_layers || std::filesystem::exists(bake.folder / "bounces-0", ignored);
  LUXEL_TRY(out.device, put_on_device(commands, bake.scene, bake.lightmaps, params));
  auto read = std::make_shared<ReadScene>();
  read->scene = std::move(bake.scene), read->first = bake.first;
  read->width = bake.width, read->height = bake.height;
  read->light_unit = bake.light_unit;
  out.lightmaps = std::move(bake.lightmaps);
  out.warnings = std::move(bake.warnings);
  out.folder = std::move(bake.folder), out.has_layers = bake.has_layers;
  LUXEL_TRY(trace::RayTracer tracer, trace::RayTracer::build(read->scene));
  read->tracer.emplace(std::move(tracer));
  out.read = std::move(read);
  out.fade.exposure_before = out.fade.exposure_newest = bake.first.exposure;
  out.has_light = out.has_last = true;
  return out;
}

Result<bool> take_news(LiveNews news, gpu::Commands& commands, ShownScene& shown,
                       std::string& said) {
  bool is_another = false;
  if (news.said) said = *news.said;
  take_more(news, shown);
  if (news.read) {
    LUXEL_TRY_STATUS(put_other_sky(news.read->scene.environment, commands, shown));
    shown.read = std::move(news.read);
    // Until there is light of an edited scene, the one before is shown.
    if (!news.lit && !shown.has_light) {
      LUXEL_TRY(shown.device, without_light(commands, shown.read->scene));
      is_another = true;
    }
  }
  if (!news.light) return is_another;
  shown.numbers = news.light->numbers;
  shown.has_last = news.light->is_last;
  if (shown.has_last) shown.warnings = std::move(news.warnings);
  if (news.lit) {
    LiveLight& first = news.before ? *news.before : *news.light;
    LUXEL_TRY(shown.device, with_light(commands, *news.lit, first));
    shown.lightmaps = pages_of(first, *news.lit);
    shown.newest = first.pages, shown.otherwise = first.with_lamps;
    shown.is_without_lamps = {first.is_without_lamps, first.is_without_lamps};
    shown.lit = std::move(news.lit);
    shown.fade = {0, 1, first.exposure, first.exposure};
    shown.waiting.reset();
    shown.has_light = is_another = true;
    if (!shown.part.is_all()) LUXEL_TRY_STATUS(put_newest(commands, shown));
    if (!news.before) return true;
  }
  if (news.light->is_sudden) {
    shown.waiting.reset();
    shown.fade = at_once(shown.fade, news.light->exposure);
    shown.device.second_light = second_light(shown.fade);
    shown.newest = std::move(news.light->pages);
    shown.otherwise = std::move(news.light->with_lamps);
    shown.is_without_lamps[shown.fade.newest] = news.light->is_without_lamps;
    LUXEL_TRY_STATUS(put_newest(commands, shown));
    return is_another;
  }
  shown.waiting = std::move(*news.light);
  LUXEL_TRY_STATUS(pass(0, commands, shown));
  return is_another;
}

Status pass(double seconds, gpu::Commands& commands, ShownScene& shown) {
  pass(seconds, shown.fade);
  // The two pictures of a light that does not change are one.
  shown.device.second_light = second_light(shown.fade);
  if (!shown.waiting || !is_free(shown.fade)) return {};
  LiveLight light = std::move(*shown.waiting);
  shown.waiting.reset();
  return fade_in(std::move(light), commands, shown);
}

Status settle(gpu::Commands& commands, ShownScene& shown) {
  while (!is_settled(shown)) LUXEL_TRY_STATUS(pass(kFade_s, commands, shown));
  return {};
}

Status leave_out_lamps(gpu::Commands& commands, ShownScene& shown) {
  // A part is made of light that has lamps.
  if (shown.without_lamps.empty() || !shown.part.is_all()) return {};
  shown.bounced.reset();
  const float exposure = shown.waiting ? shown.waiting->exposure : shown.fade.exposure_newest;
  shown.waiting.reset();
  shown.fade = at_once(shown.fade, exposure);
  shown.device.second_light = second_light(shown.fade);
  shown.otherwise = std::exchange(shown.newest, std::exchange(shown.without_lamps, {}));
  shown.is_without_lamps[shown.fade.newest] = true;
  return put_newest(commands, shown);
}

Status draw_lamps_or_not(bool are_drawn, gpu::Commands& commands, ShownScene& shown) {
  bool& is_without = shown.is_without_lamps[shown.fade.newest];
  if (shown.otherwise.empty() || is_without == are_drawn) return {};
  std::swap(shown.newest, shown.otherwise);
  is_without = are_drawn;
  shown.fade = at_once(shown.fade, shown.fade.exposure_newest);
  shown.device.second_light = second_light(shown.fade);
  return put_newest(commands, shown);
}

float lamp_share(const ShownScene& shown) {
  const float second = shown.device.second_light;
  return (shown.is_without_lamps[0] ? 1 - second : 0) + (shown.is_without_lamps[1] ? second : 0);
}

bool is_settled(const ShownScene& shown) { return !shown.waiting && is_free(shown.fade); }

Result<Look> look_of(const ShownScene& shown) {
  if (shown.lightmaps.pictures.empty())
    return fail(
        ErrorCode::bad_input,
        "there is no lightmap to look into: light of .lxr files is computed for each picture");
  Look out;
  if (shown.folder.empty()) {
    out = look_at(shown.drawn(), shown.lightmaps, shown.light_uv());
  } else {
    LUXEL_TRY(out, look_into(shown.folder, shown.drawn(), shown.lightmaps));
  }
  out.unit = shown.read->light_unit;
  return out;
}

}  // namespace luxel::view
