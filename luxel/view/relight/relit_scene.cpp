#include "luxel/view/relight/relit_scene.h"

#include "luxel/base/clock.h"

namespace luxel::view {
namespace {

/// Sets the glow of materials and the background that the eye sees.
void show_glow(const Lamps& lamps, const OpenedLxr& opened, DeviceScene& scene) {
  const std::vector<scene::Material>& materials = opened.read->scene.materials;
  for (size_t m = 0; m < materials.size(); ++m)
    set_emission(m, emission_now(materials[m], lamps, opened.lamps), scene);
  scene.background = lamps.background;
}

/// The lamps, their shadows, and patches' light from them. Returns what it took [ms].
Result<double> draw_shadows(gpu::Commands& commands,
                            const std::vector<scene::PunctualLight>& lights,
                            const trace::CameraRays* eye, LampDrawing& drawing,
                            DeviceScene& scene) {
  const Clock::time_point start = Clock::now();
  const gpu::Device& device = commands.device();
  LUXEL_TRY_STATUS(set_lamps(device, lights, eye, drawing.direct, scene));
  LUXEL_TRY_STATUS(commands.run([&](VkCommandBuffer buffer) {
    draw_shadow_maps(device, buffer, scene, drawing.direct);
    if (drawing.patches) light_points(device, buffer, scene, *drawing.patches);
  }));
  return 1e3 * seconds_since(start);
}

Result<LightAtPoints> patches_on_device(const gpu::Device& device, const OpenedLxr& opened,
                                        const DeviceScene& scene) {
  std::vector<LitPoint> points;
  for (const matrix::PatchPoint& p : opened.light.relighter.data().probe)
    points.push_back({p.position, p.normal});
  return make_light_at_points(device, scene, points);
}

}  // namespace

PatchLight patch_light_of(const gpu::Device& device) {
  return device.type == VK_PHYSICAL_DEVICE_TYPE_CPU ? PatchLight::by_rays : PatchLight::on_device;
}

namespace {

/// A relighter on the device, if that knows the file's codec and has the memory for it. Errors: the
/// device is lost.
Result<std::optional<RelitOnDevice>> relit_on_device(gpu::Commands& commands,
                                                     const OpenedLxr& opened,
                                                     const DeviceScene& scene) {
  auto made = make_relit_on_device(commands, opened.light, scene);
  if (made) return std::move(*made);
  const ErrorCode code = made.error().code;
  if (code == ErrorCode::unsupported || code == ErrorCode::out_of_memory) return std::nullopt;
  return Failure{made.error()};
}

}  // namespace

Result<RelitScene> lxr_shown(gpu::Commands& commands, PatchLight patches, OpenedLxr& opened) {
  const std::array pages{image::to_half(opened.light.indirect)};
  const std::vector<size_t> of_material(opened.read->scene.materials.size(), 0);
  DeviceSceneParams params;
  params.light_changes = true, params.shadow_side = kShadowSide;
  RelitScene out;
  DeviceScene& scene = out.shown.device;
  LUXEL_TRY(scene, put_on_device(commands, opened.read->scene, {pages, of_material}, params));
  out.shown.read = opened.read;
  out.shown.fade.exposure_before = out.shown.fade.exposure_newest = opened.read->first.exposure;
  out.shown.has_light = out.shown.has_last = true;
  LUXEL_TRY(out.lamps.direct, make_direct_light(commands.device(), scene));
  const size_t probes = opened.light.relighter.data().probe.size();
  if (patches == PatchLight::on_device) {
    LUXEL_TRY(out.lamps.relit, relit_on_device(commands, opened, scene));
    if (!out.lamps.relit) patches = PatchLight::by_maps;
  }
  if (patches == PatchLight::by_maps && can_light_points(commands.device(), probes)) {
    LUXEL_TRY(out.lamps.patches, patches_on_device(commands.device(), opened, scene));
  }
  LUXEL_TRY_STATUS(
      follow_lamps(commands, opened.lamps, nullptr, opened, out.lamps, scene).map([](LightTimes) {
      }));
  return out;
}

Result<LightTimes> follow_lamps(gpu::Commands& commands, const Lamps& lamps,
                                const trace::CameraRays* eye, OpenedLxr& opened,
                                LampDrawing& drawing, DeviceScene& scene) {
  LightTimes out;
  LUXEL_TRY(out.shadows, draw_shadows(commands, shining(lamps), eye, drawing, scene));
  show_glow(lamps, opened, scene);
  if (drawing.relit) {
    LUXEL_TRY(opened.light.took, relight_on_device(commands, lamps, *drawing.relit, scene));
  } else {
    relight(lamps, opened.light,
            drawing.patches ? drawing.patches->result() : std::span<const Rgb>());
    const Clock::time_point start = Clock::now();
    const std::array pages{image::to_half(opened.light.indirect)};
    LUXEL_TRY_STATUS(put_light(commands, pages, 0, scene));
    opened.light.took.map += 1e3 * seconds_since(start);
  }
  const RelitLight::Milliseconds& took = opened.light.took;
  out.direct = took.direct, out.bounces = took.bounces, out.places = took.places;
  out.map = took.map;
  return out;
}

Result<double> follow_eye(gpu::Commands& commands, const Lamps& lamps, const trace::CameraRays& eye,
                          LampDrawing& drawing, DeviceScene& scene) {
  const std::vector<scene::PunctualLight> lights = shining(lamps);
  const uint32_t side = scene.shadow_maps.picture->params.width;
  if (plan_shadows(lights, scene.bounds, side, &eye).maps == drawing.direct.drawn) return 0;
  return draw_shadows(commands, lights, &eye, drawing, scene);
}

}  // namespace luxel::view
