#include "luxel/view/draw/surface_drawing.h"

#include <map>
#include <tuple>

#include "luxel/base/check.h"
#include "luxel/view/draw/among_surfaces.h"
#include "luxel/view/draw/surface_shared.h"
#include "luxel/view/shaders/surface.frag.h"
#include "luxel/view/shaders/surface.vert.h"

namespace luxel::view {

/// The features of a surface that its shader draws, in the order of the shader's constants, and its
/// culling.
struct Drawn {
  uint32_t lamps = 2;         ///< 0: none, 1: with sharp shadows, 2: all
  uint32_t lets_through = 1;  ///< light is scattered to the other side
  uint32_t fades = 1;         ///< one light into another
  uint32_t has_more = 1;      ///< it glows, or is metal
  VkCullModeFlags cull = VK_CULL_MODE_NONE;

  auto tied() const { return std::tie(lamps, lets_through, fades, has_more, cull); }
  friend bool operator<(const Drawn& a, const Drawn& b) { return a.tied() < b.tied(); }
};

namespace {

using on_device::SurfacePush;

VkCullModeFlags cull_of(const DeviceScene& scene, uint32_t instance, uint32_t material) {
  if (scene.is_double_sided[material]) return VK_CULL_MODE_NONE;
  return scene.is_mirrored[instance] ? VK_CULL_MODE_FRONT_BIT : VK_CULL_MODE_BACK_BIT;
}

Drawn drawn_of(const DeviceScene& scene, uint32_t instance, uint32_t material) {
  Drawn out;
  out.lamps = light_now(scene).lamp_count == 0 ? 0 : scene.has_soft_shadows ? 2 : 1;
  out.lets_through = scene.scatters_through[material];
  out.fades = scene.second_light > 0;
  out.has_more = scene.glows_or_is_metal[material];
  out.cull = cull_of(scene, instance, material);
  return out;
}

}  // namespace

struct SurfaceShaders::Made {
  const gpu::Device* device = nullptr;
  gpu::DrawParams params;
  gpu::Pipeline any;
  std::map<Drawn, Result<gpu::Pipeline>> others;
};

SurfaceShaders::SurfaceShaders() = default;
SurfaceShaders::SurfaceShaders(SurfaceShaders&&) noexcept = default;
SurfaceShaders& SurfaceShaders::operator=(SurfaceShaders&&) noexcept = default;
SurfaceShaders::~SurfaceShaders() = default;

Result<SurfaceShaders> SurfaceShaders::make(const gpu::Device& device, VkFormat color,
                                            VkSampleCountFlagBits samples) {
  SurfaceShaders out;
  out.made_ = std::make_unique<Made>();
  Made& made = *out.made_;
  made.device = &device;
  made.params = among_surfaces(color, samples);
  made.params.vertex = surface_vert, made.params.fragment = surface_frag;
  made.params.interface = {
      sizeof(SurfacePush),
      std::vector<VkDescriptorType>(kLookUps, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER)};
  LUXEL_TRY(made.any, gpu::make_draw_pipeline(device, made.params));
  return out;
}

const gpu::Pipeline& SurfaceShaders::any() const { return made_->any; }

const gpu::Pipeline& SurfaceShaders::for_surfaces(const DeviceScene& scene, uint32_t instance,
                                                  uint32_t material) const {
  const Drawn drawn = drawn_of(scene, instance, material);
  auto found = made_->others.find(drawn);
  if (found == made_->others.end()) {
    gpu::DrawParams params = made_->params;
    params.constants = {drawn.lamps, drawn.lets_through, drawn.fades, drawn.has_more};
    params.cull = drawn.cull;
    found = made_->others.emplace(drawn, gpu::make_draw_pipeline(*made_->device, params)).first;
  }
  return found->second ? *found->second : made_->any;
}

void draw_surfaces(const gpu::Device& device, VkCommandBuffer commands,
                   const SurfaceShaders& shaders, const DeviceScene& scene, const SurfaceView& view,
                   const Frame& frame) {
  SurfacePush push{};
  push.clip_from_world = view.clip_from_world, push.vertices = scene.vertices.address;
  push.materials = scene.materials.address, push.instances = scene.instances.address;
  push.light_now = scene.light_now.address, push.second_light = scene.second_light;
  push.exposure = frame.exposure, push.show = uint32_t(frame.show);
  device.vk.vkCmdBindIndexBuffer(commands, scene.indices.buffer.get(), 0, VK_INDEX_TYPE_UINT32);
  for (push.instance = 0; push.instance < scene.mesh_of.size(); ++push.instance)
    for (const DrawRange& range : scene.ranges[scene.mesh_of[push.instance]]) {
      push.material = range.material;
      const gpu::Pipeline& pipeline = shaders.for_surfaces(scene, push.instance, push.material);
      gpu::bind(device, commands, pipeline, push);
      gpu::bind_set(device, commands, pipeline, view.sets[push.material]);
      device.vk.vkCmdDrawIndexed(commands, range.indices, 1, range.first_index, 0, 0);
    }
}

}  // namespace luxel::view
