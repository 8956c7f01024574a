#include "luxel/view/draw/quadratic.h"

#include "luxel/base/check.h"
#include "luxel/view/draw/among_surfaces.h"
#include "luxel/view/draw/quadratic_shared.h"
#include "luxel/view/shaders/quadratic.frag.h"
#include "luxel/view/shaders/quadratic.vert.h"

namespace luxel::view {
namespace {

using on_device::QuadraticPush, on_device::QuadraticTriangle;

}  // namespace

Result<DeviceQuadratics> put_quadratics(const gpu::Device& device,
                                        const display::QuadraticMesh& mesh,
                                        std::span<const uint32_t> group) {
  LUXEL_CHECK(group.size() == mesh.triangles.size());
  if (group.empty()) return fail(ErrorCode::bad_input, "there is no surface to draw");
  std::vector<QuadraticTriangle> triangles(group.size());
  for (size_t t = 0; t < triangles.size(); ++t) {
    for (size_t k = 0; k < 3; ++k) triangles[t].corner[k] = mesh.vertices[mesh.triangles[t][k]];
    triangles[t].irradiance = mesh.irradiance[t];
    triangles[t].reflectance = mesh.reflectance[t], triangles[t].emission = mesh.emission[t];
    triangles[t].group = group[t], triangles[t].two_sided = mesh.two_sided[t];
  }
  DeviceQuadratics out;
  LUXEL_TRY(out.triangles, gpu::buffer_with(device, std::as_bytes(std::span(triangles)),
                                            "the triangles of the light"));
  out.count = uint32_t(triangles.size());
  return out;
}

Result<gpu::Pipeline> make_quadratic_shader(const gpu::Device& device, VkFormat color,
                                            VkSampleCountFlagBits samples) {
  gpu::DrawParams params = among_surfaces(color, samples);
  params.vertex = quadratic_vert, params.fragment = quadratic_frag;
  params.interface.push_bytes = sizeof(QuadraticPush);
  return gpu::make_draw_pipeline(device, params);
}

void draw_quadratics(const gpu::Device& device, VkCommandBuffer commands,
                     const gpu::Pipeline& shader, const DeviceQuadratics& mesh,
                     const std::optional<ExactPixels>& exact,
                     const std::array<float, 16>& clip_from_world, const Frame& frame) {
  QuadraticPush push{};
  push.clip_from_world = clip_from_world, push.triangles = mesh.triangles.address;
  if (exact) push.exact = exact->pixels.address, push.exact_width = exact->width;
  push.exposure = frame.exposure, push.show = uint32_t(frame.show);
  gpu::bind(device, commands, shader, push);
  device.vk.vkCmdDraw(commands, 3 * mesh.count, 1, 0, 0);
}

}  // namespace luxel::view
