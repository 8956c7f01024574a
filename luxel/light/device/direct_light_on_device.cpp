#include "luxel/light/device/direct_light_on_device.h"

#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/light/both_punctual_light.h"
#include "luxel/light/both_triangle_light.h"
#include "luxel/light/device/direct_light_shared.h"
#include "luxel/light/device/shaders/direct_light.comp.h"
#include "luxel/light/shadow_rays.h"

namespace luxel::light {
namespace {

/// Groups of receivers, each with any number of rays.
constexpr gpu::PieceSize kFirstPiece{64};
/// Receivers that are sent at a time: 11 MB.
constexpr size_t kReceiversAtATime = size_t(1) << 18;

using on_device::DirectPush, on_device::kDirectThreads;

/// Steps that a scene's lights need.
std::vector<uint32_t> steps_of(const Lights& lights) {
  std::vector<uint32_t> out;
  if (!lights.triangles.empty())
    out.push_back(lights.triangles.size() <= both::kMaxAllTriangles ? on_device::kAllTriangles
                                                                    : on_device::kDrawnTriangles);
  if (!lights.punctual.empty()) out.push_back(on_device::kPunctualLights);
  if (lights.punctual.size() > both::kMaxAllPunctual && !lights.punctual_nodes.empty())
    out.push_back(on_device::kDrawnPunctualLights);
  if (!lights.around.bright_texels.empty()) out.push_back(on_device::kBrightTexels);
  return out;
}

}  // namespace

Status DeviceDirectLight::make_steps(const trace::DeviceRayTracer& tracer, const Lights& lights) {
  const gpu::Spirv shader = direct_light_comp(tracer.kind());
  const bool all_even =
      std::ranges::none_of(lights.triangles, &TriangleLight::textured) && lights.profiles.empty();
  for (const uint32_t step : steps_of(lights)) {
    steps_.emplace_back();
    steps_.back().is_punctual =
        step == on_device::kPunctualLights || step == on_device::kDrawnPunctualLights;
    LUXEL_TRY(steps_.back().pipeline,
              gpu::make_compute_pipeline(commands_->device(), shader, {sizeof(DirectPush), {}},
                                         {tracer.shader_constant(), step, uint32_t(all_even)}));
  }
  return {};
}

Result<DeviceDirectLight> DeviceDirectLight::make(const trace::DeviceRayTracer& tracer,
                                                  gpu::Commands& commands,
                                                  const scene::Scene& scene, const Lights& lights) {
  LUXEL_CHECK(tracer.device().has_doubles);
  DeviceDirectLight out(commands);
  LUXEL_TRY(out.lights_, upload_lights(commands, tracer, scene, lights));
  LUXEL_TRY_STATUS(out.make_steps(tracer, lights));
  return out;
}

Status DeviceDirectLight::make_room(size_t count) {
  if (room_ >= count) return {};
  const gpu::Device& device = commands_->device();
  constexpr std::string_view kWhat = "the buffer of lit places";
  sent_ = {}, receivers_ = {}, light_ = {}, answered_ = {}, room_ = 0;
  const size_t in = count * sizeof(on_device::Receiver), out = count * sizeof(on_device::LightAt);
  LUXEL_TRY(sent_, gpu::make_buffer(device, in, gpu::Access::from_host, kWhat));
  LUXEL_TRY(receivers_, gpu::make_buffer(device, in, gpu::Access::device, kWhat));
  LUXEL_TRY(light_, gpu::make_buffer(device, out, gpu::Access::device, kWhat));
  LUXEL_TRY(answered_, gpu::make_buffer(device, out, gpu::Access::to_host, kWhat));
  room_ = count;
  return {};
}

/// Works the light of the first `count` receivers of sent_ out: it lies in answered_ then.
Status DeviceDirectLight::light_sent(size_t count, const LightAsked& asked,
                                     const Progress& progress) {
  const gpu::Device& device = commands_->device();
  LUXEL_TRY_STATUS(
      gpu::copy_bytes(*commands_, sent_, receivers_, count * sizeof(on_device::Receiver)));
  LUXEL_TRY_STATUS(commands_->run([&](VkCommandBuffer c) {
    device.vk.vkCmdFillBuffer(c, light_.buffer.get(), 0, VK_WHOLE_SIZE, 0);
  }));
  const DirectPush push{.setup = lights_.setup.address,
                        .receivers = receivers_.address,
                        .light = light_.address,
                        .count = uint32_t(count),
                        .samples = uint32_t(asked.samples),
                        .first_group = 0};
  // Each step adds to what those before it have found.
  for (Step& step : steps_) {
    if (asked.punctual_alone && !step.is_punctual) continue;
    gpu::PieceSize& piece = step.pieces.try_emplace(asked.samples, kFirstPiece).first->second;
    LUXEL_TRY(const double took,
              gpu::run_groups(*commands_, step.pipeline, push,
                              (count + kDirectThreads - 1) / kDirectThreads, piece, &progress));
    seconds_ += took;
  }
  return gpu::copy_bytes(*commands_, light_, answered_, count * sizeof(on_device::LightAt));
}

Result<uint64_t> DeviceDirectLight::light_at(std::span<const Receiver> receivers,
                                             const LightAsked& asked, std::span<LightAt> out,
                                             Progress& progress) {
  LUXEL_CHECK(asked.samples >= 1 && out.size() == receivers.size());
  uint64_t rays = 0;
  for (size_t first = 0; first < receivers.size(); first += kReceiversAtATime) {
    const auto these =
        receivers.subspan(first, std::min(kReceiversAtATime, receivers.size() - first));
    LUXEL_TRY_STATUS(make_room(these.size()));
    auto* sent = reinterpret_cast<on_device::Receiver*>(sent_.mapped);
    parallel_for(these.size(), 4096, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        const Receiver& r = these[k];
        sent[k] = {r.position, r.normal, r.geometric_normal, on_device::halves(r.seed)};
      }
    });
    LUXEL_TRY_STATUS(light_sent(these.size(), asked, progress));
    const auto* light = reinterpret_cast<const on_device::LightAt*>(answered_.mapped);
    for (size_t k = 0; k < these.size(); ++k) {
      out[first + k] = {light[k].irradiance, light[k].variance, light[k].split_variance};
      rays += light[k].rays;
    }
  }
  return rays;
}

}  // namespace luxel::light
