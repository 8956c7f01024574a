#include "luxel/view/draw/technique_drawing.h"

#include <cstring>

#include "luxel/base/check.h"
#include "luxel/display/local_light.h"
#include "luxel/view/draw/among_surfaces.h"
#include "luxel/view/draw/technique_shared.h"
#include "luxel/view/shaders/technique.frag.h"
#include "luxel/view/shaders/technique.vert.h"

namespace luxel::view {
namespace {

using on_device::LitElement, on_device::Looking, on_device::Phong, on_device::TechniquePush;

std::span<LitElement> elements_of(const DeviceTechniques& t) {
  return {reinterpret_cast<LitElement*>(t.elements.mapped), t.elements.size / sizeof(LitElement)};
}

Result<gpu::Buffer> put_elements(const gpu::Device& device, std::span<const Rgb> reflectance) {
  LUXEL_TRY(gpu::Buffer out,
            gpu::make_buffer(device, std::max<size_t>(1, reflectance.size()) * sizeof(LitElement),
                             gpu::Access::from_host, "the light of elements"));
  std::memset(out.mapped, 0, size_t(out.size));
  auto* elements = reinterpret_cast<LitElement*>(out.mapped);
  for (size_t i = 0; i < reflectance.size(); ++i) elements[i].reflectance = reflectance[i];
  return out;
}

Result<DeviceCorners> put_corners(const gpu::Device& device, const SurfaceCorners& from) {
  DeviceCorners out;
  out.ranges = from.ranges;
  const SurfaceCorner nothing{};
  const std::span<const SurfaceCorner> corners =
      from.corners.empty() ? std::span(&nothing, 1) : std::span(from.corners);
  LUXEL_TRY(out.corners, gpu::buffer_with(device, std::as_bytes(corners), "the triangles"));
  return out;
}

gpu::DrawParams technique_params(VkFormat color, VkSampleCountFlagBits samples,
                                 VkCullModeFlags cull) {
  gpu::DrawParams params = among_surfaces(color, samples);
  params.vertex = technique_vert, params.fragment = technique_frag;
  params.interface = {
      sizeof(TechniquePush),
      std::vector<VkDescriptorType>(kLookUps, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER)};
  params.cull = cull;
  return params;
}

/// display::local_light_at() from the frame's camera.
Looking looking_at(const scene::Scene& lamps, const scene::Camera& camera) {
  const display::Viewer viewer(camera);
  const display::LocalLights lights = display::local_lights(lamps, camera);
  return {viewer.eye,     viewer.orthographic, viewer.back,
          lights.ambient, lights.light,        -lights.direction};
}

}  // namespace

Result<TechniqueShaders> make_technique_shaders(const gpu::Device& device, VkFormat color,
                                                VkSampleCountFlagBits samples) {
  TechniqueShaders out;
  LUXEL_TRY(out.one_sided, gpu::make_draw_pipeline(
                               device, technique_params(color, samples, VK_CULL_MODE_BACK_BIT)));
  LUXEL_TRY(out.double_sided,
            gpu::make_draw_pipeline(device, technique_params(color, samples, VK_CULL_MODE_NONE)));
  return out;
}

Result<DeviceTechniques> put_techniques(const gpu::Device& device, const scene::Scene& scene) {
  DeviceTechniques out;
  out.lamps.lights = scene.lights;
  LUXEL_TRY(out.own, put_corners(device, corners_of(scene)));
  LUXEL_TRY(out.elements, put_elements(device, {}));
  std::vector<Phong> highlights{{{}, 1}};  // a buffer is not empty
  for (const scene::Material& m : scene.materials)
    highlights.push_back({min(max(m.specular, Rgb{}), Rgb{1, 1, 1}), m.sharpness});
  if (highlights.size() > 1) highlights.erase(highlights.begin());
  LUXEL_TRY(out.highlights,
            gpu::buffer_with(device, std::as_bytes(std::span(highlights)), "the highlights"));
  LUXEL_TRY(out.looking, gpu::make_buffer(device, sizeof(Looking), gpu::Access::from_host,
                                          "the light of techniques"));
  return out;
}

Status put_mesh(const gpu::Device& device, const SurfaceCorners& mesh,
                std::span<const Rgb> reflectance, DeviceTechniques& out) {
  LUXEL_TRY(DeviceCorners corners, put_corners(device, mesh));
  LUXEL_TRY(out.elements, put_elements(device, reflectance));
  out.mesh = std::move(corners);
  return {};
}

void put_irradiance(std::span<const Rgb> irradiance, DeviceTechniques& out) {
  const std::span<LitElement> elements = elements_of(out);
  LUXEL_CHECK(irradiance.size() <= elements.size());
  for (size_t i = 0; i < irradiance.size(); ++i) elements[i].irradiance = irradiance[i];
}

void draw_technique(const gpu::Device& device, VkCommandBuffer commands,
                    const TechniqueShaders& shaders, const DeviceTechniques& techniques,
                    const DeviceScene& scene, const TechniqueView& view, const Frame& frame) {
  const Looking looking = looking_at(techniques.lamps, frame.camera);
  std::memcpy(techniques.looking.mapped, &looking, sizeof(looking));
  const bool of_mesh = techniques.mesh && needs_mesh(*frame.technique);
  const DeviceCorners& drawn = of_mesh ? *techniques.mesh : techniques.own;
  TechniquePush push{};
  push.clip_from_world = view.clip_from_world, push.corners = drawn.corners.address;
  push.elements = techniques.elements.address, push.highlights = techniques.highlights.address;
  push.materials = scene.materials.address, push.looking = techniques.looking.address;
  push.technique = uint32_t(*frame.technique), push.exposure = frame.exposure;
  for (const CornerRange& range : drawn.ranges) {
    const gpu::Pipeline& pipeline =
        scene.is_double_sided[range.material] ? shaders.double_sided : shaders.one_sided;
    push.material = range.material;
    gpu::bind(device, commands, pipeline, push);
    gpu::bind_set(device, commands, pipeline, view.materials[range.material]);
    device.vk.vkCmdDraw(commands, range.count, 1, range.first, 0);
  }
}

}  // namespace luxel::view
