#include "luxel/view/draw/overlay.h"

#include <algorithm>
#include <span>

#include "luxel/view/draw/among_surfaces.h"
#include "luxel/view/draw/overlay_shared.h"
#include "luxel/view/shaders/overlay.frag.h"
#include "luxel/view/shaders/overlay.vert.h"

namespace luxel::view {
namespace {

constexpr VkDescriptorType kOverlayLookUp = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
/// Light, base colour, texels.png, error.png, overlaps, the second light.
constexpr size_t kOverlayLookUps = 6;
/// Where DeviceScene::bindings have the second light.
constexpr size_t kSecondLight = 6;

using on_device::OverlayPush;

/// Charts and seams of all triangles, in the order in which they are drawn.
std::vector<uint32_t> drawn_charts(const scene::Scene& scene, const Look& look) {
  std::vector<uint32_t> out;
  uint32_t first = 0;
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const MeshCharts& charts = look.charts[m];
    for (const uint32_t t : triangles_by_material(scene.meshes[m]))
      out.push_back(charts.chart_of.empty() ? 0
                                            : (first + charts.chart_of[t]) << 3 | charts.seams[t]);
    first += charts.charts;
  }
  return out;
}

/// Pictures of three or four channels, or of one that stands for all, as display values.
std::vector<std::byte> bytes_of_picture(const image::Image8& from) {
  std::vector<std::byte> out;
  const auto channels = size_t(from.channels);
  for (size_t i = 0; i < from.data.size(); i += channels) {
    for (size_t c = 0; c < 3; ++c) out.push_back(std::byte(from.data[i + (channels > 1 ? c : 0)]));
    out.push_back(std::byte(255));
  }
  return out;
}

/// A picture of each page, whose pixels are looked up as they are; white ones where there is none.
Result<std::vector<gpu::Binding>> put_pages(gpu::Commands& commands,
                                            std::vector<image::Image8> pages, size_t count,
                                            std::string_view what, Overlay& out) {
  if (pages.empty()) pages.resize(count, {1, 1, 1, std::vector<uint8_t>(1, 255)});
  std::vector<gpu::Binding> bindings;
  for (const image::Image8& page : pages) {
    gpu::PictureParams params;
    params.format = VK_FORMAT_R8G8B8A8_SRGB;
    params.width = uint32_t(page.width), params.height = uint32_t(page.height);
    LUXEL_TRY(gpu::Picture picture,
              gpu::picture_with(commands, params, bytes_of_picture(page), what));
    out.pictures.push_back(std::move(picture));
    bindings.push_back({&out.pictures.back(), out.samplers.front().get()});
  }
  return bindings;
}

}  // namespace

Result<gpu::Pipeline> make_overlay_shader(const gpu::Device& device, VkFormat color,
                                          VkSampleCountFlagBits samples) {
  gpu::DrawParams params = among_surfaces(color, samples);
  params.vertex = overlay_vert, params.fragment = overlay_frag;
  params.interface = {sizeof(OverlayPush),
                      std::vector<VkDescriptorType>(kOverlayLookUps, kOverlayLookUp)};
  return gpu::make_draw_pipeline(device, params);
}

Result<Overlay> make_overlay(gpu::Commands& commands, const gpu::Pipeline& shader,
                             const scene::Scene& scene, const pipeline::LightmapPages& lightmaps,
                             const Look& look, const DeviceScene& on_device) {
  const gpu::Device& device = commands.device();
  Overlay out;
  out.irradiance = look.irradiance, out.density = look.density;
  const std::vector<uint32_t> charts = drawn_charts(scene, look);
  LUXEL_TRY(out.charts, gpu::buffer_with(device, std::as_bytes(std::span(charts)),
                                         "the charts of the lightmap"));
  LUXEL_TRY(out.shown, gpu::make_buffer(device, sizeof(on_device::Look), gpu::Access::device,
                                        "what is shown of a bake"));
  constexpr auto kClamp = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  LUXEL_TRY(gpu::OwnedSampler sampler,
            gpu::make_sampler(device, {VK_FILTER_NEAREST, kClamp, kClamp}));
  out.samplers.push_back(std::move(sampler));
  const size_t pages = lightmaps.pictures.size();
  LUXEL_TRY(const auto texels, put_pages(commands, look.texels, pages, "texels.png", out));
  LUXEL_TRY(const auto errors, put_pages(commands, look.errors, pages, "error.png", out));
  LUXEL_TRY(const auto overlaps, put_pages(commands, look.overlaps, pages, "the overlaps", out));
  std::vector<std::vector<gpu::Binding>> bindings;
  for (size_t m = 0; m < on_device.bindings.size(); ++m) {
    const size_t page = lightmaps.of_material[m];
    const std::vector<gpu::Binding>& known = on_device.bindings[m];
    bindings.push_back(
        {known[0], known[1], texels[page], errors[page], overlaps[page], known[kSecondLight]});
  }
  LUXEL_TRY(out.sets, gpu::make_sets(device, shader, bindings));
  return out;
}

void set_shown(const gpu::Device& device, VkCommandBuffer commands, const Overlay& overlay,
               const DeviceScene& scene, const Frame& frame, Vec3 forward) {
  const ColorScale scale = frame.show == Show::density
                               ? scale_of(frame.density, overlay.density)
                               : scale_of(frame.irradiance, overlay.irradiance);
  on_device::Look shown{};
  shown.corners = scene.indices.address, shown.charts = overlay.charts.address;
  shown.light_now = scene.light_now.address, shown.second_light = scene.second_light;
  shown.show = uint32_t(frame.show), shown.channel = uint32_t(frame.channel);
  shown.low = scale.low, shown.high = scale.high;
  shown.is_logarithmic = scale.is_logarithmic;
  shown.exposure = frame.exposure;
  shown.forward = forward;
  shown.colors = packed_false_colors();
  gpu::full_barrier(device, commands);
  device.vk.vkCmdUpdateBuffer(commands, overlay.shown.buffer.get(), 0, sizeof(shown), &shown);
  gpu::full_barrier(device, commands);
}

void draw_overlay(const gpu::Device& device, VkCommandBuffer commands, const gpu::Pipeline& shader,
                  const Overlay& overlay, const DeviceScene& scene,
                  const std::array<float, 16>& clip_from_world) {
  OverlayPush push{};
  push.clip_from_world = clip_from_world, push.vertices = scene.vertices.address;
  push.materials = scene.materials.address, push.instances = scene.instances.address;
  push.look = overlay.shown.address;
  for (push.instance = 0; push.instance < scene.mesh_of.size(); ++push.instance)
    for (const DrawRange& range : scene.ranges[scene.mesh_of[push.instance]]) {
      push.material = range.material;
      const bool is_mirrored = scene.is_mirrored[push.instance];
      push.culled = scene.is_double_sided[range.material] ? 0 : is_mirrored ? 2 : 1;
      gpu::bind(device, commands, shader, push);
      gpu::bind_set(device, commands, shader, overlay.sets.sets[range.material]);
      device.vk.vkCmdDraw(commands, range.indices, 1, range.first_index, 0);
    }
}

}  // namespace luxel::view
