#include "luxel/solve/device/device_relighter.h"

#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "luxel/base/check.h"
#include "luxel/base/clock.h"
#include "luxel/gpu/pieces.h"
#include "luxel/solve/device/moved_lights_shared.h"
#include "luxel/solve/device/relight_buffers.h"
#include "luxel/solve/device/relight_shared.h"
#include "luxel/solve/device/shaders/relight_direct.comp.h"
#include "luxel/solve/device/shaders/relight_steps.comp.h"
#include "luxel/trace/vulkan/device_ray_tracer.h"

namespace luxel::device {
namespace {

/// Shadow rays that are part of an update's one command buffer, at most.
constexpr uint64_t kMostRaysAtOnce = uint64_t(1) << 22;

using on_device::MovedLight, on_device::MovedPush, on_device::StepPush;

static_assert(sizeof(matrix::PatchPoint) == 24);  // as shaders/relight_direct.comp reads it

MovedLight moved_light(const scene::PunctualLight& light) {
  return {light.intensity,
          light.position,
          light.direction,
          light.range_m,
          std::cos(light.inner_cone_rad),
          std::cos(light.outer_cone_rad),
          uint32_t(light.kind)};
}

uint32_t groups_of(uint32_t threads) {
  return (threads + on_device::kRelightThreads - 1) / on_device::kRelightThreads;
}

}  // namespace

struct DeviceRelighter::Impl {
  const gpu::Device& device;
  const matrix::RelightData& data;
  scene::Scene occluders;
  std::optional<gpu::Commands> commands{};
  std::optional<trace::DeviceRayTracer> tracer{};
  RelightBuffers buffers{};
  gpu::Buffer probes{}, lights{}, probes_sent{};
  std::vector<Rgb> mean_emission{};  ///< B_e per material, as baked
  gpu::Pipeline direct{};
  gpu::PieceSize direct_piece{};  ///< of groups, where direct light is not part of the one buffer
  std::array<gpu::Pipeline, on_device::kRelightSteps> step{};
  double seconds = 0;

  Status make_pipelines();
  Status send_lights(std::span<const scene::PunctualLight> wanted);
  void send_materials(std::span<const Rgb> emission) const;
  void run(VkCommandBuffer c, uint32_t which, uint32_t groups, uint32_t first, uint32_t count,
           Rgb background) const;
  void per_patch(VkCommandBuffer c, uint32_t which, Rgb background = {}) const;
  template <class Push>
  void dispatch(VkCommandBuffer c, const gpu::Pipeline& pipeline, Push push, uint32_t groups) const;
  MovedPush direct_push(const matrix::RelightLights& from) const;
  bool has_many_rays(const matrix::RelightLights& from) const;
  void light_probes(VkCommandBuffer c, const matrix::RelightLights& from) const;
  void multiply(VkCommandBuffer c) const;
  void sweep(VkCommandBuffer c, int sweeps) const;
  void bounce(VkCommandBuffer c) const;
};

Status DeviceRelighter::Impl::make_pipelines() {
  for (uint32_t k = 0; k < on_device::kRelightSteps; ++k) {
    LUXEL_TRY(step[k],
              gpu::make_compute_pipeline(device, relight_steps_comp, {sizeof(StepPush), {}}, {k}));
  }
  LUXEL_TRY(direct,
            gpu::make_compute_pipeline(device, relight_direct_comp(tracer->kind()),
                                       {sizeof(MovedPush), {}}, {tracer->shader_constant()}));
  return {};
}

/// Where the processor writes lights is mapped: the device reads them there.
Status DeviceRelighter::Impl::send_lights(std::span<const scene::PunctualLight> wanted) {
  if (lights.size == 0 || wanted.size() * sizeof(MovedLight) > lights.size) {
    const size_t room = std::max<size_t>(16, 2 * wanted.size());
    LUXEL_TRY(lights, gpu::make_buffer(device, room * sizeof(MovedLight), gpu::Access::from_host,
                                       "the buffer of lights"));
  }
  auto* to = reinterpret_cast<MovedLight*>(lights.mapped);
  for (size_t k = 0; k < wanted.size(); ++k) to[k] = moved_light(wanted[k]);
  return {};
}

void DeviceRelighter::Impl::send_materials(std::span<const Rgb> emission) const {
  auto* to = reinterpret_cast<float*>(buffers.radiosity_of_material.mapped);
  for (size_t m = 0; m < data.material_name.size(); ++m) {
    const Rgb b = emission.empty() ? mean_emission[m] : emission[m] * kPi;
    to[3 * m] = b.x, to[3 * m + 1] = b.y, to[3 * m + 2] = b.z;
  }
}

/// As many groups as are wanted, of which a device takes only so many at a time.
template <class Push>
void DeviceRelighter::Impl::dispatch(VkCommandBuffer c, const gpu::Pipeline& pipeline, Push push,
                                     uint32_t groups) const {
  const uint32_t most = device.limits.maxComputeWorkGroupCount[0];
  for (push.first_group = 0; push.first_group < groups; push.first_group += most) {
    gpu::bind(device, c, pipeline, push);
    device.vk.vkCmdDispatch(c, std::min(most, groups - push.first_group), 1, 1);
  }
}

/// All that came before is done, then the step runs.
void DeviceRelighter::Impl::run(VkCommandBuffer c, uint32_t which, uint32_t groups, uint32_t first,
                                uint32_t count, Rgb background) const {
  if (groups == 0) return;
  gpu::full_barrier(device, c);
  dispatch(c, step[which], StepPush{buffers.setup.address, first, count, 0, background}, groups);
}

void DeviceRelighter::Impl::per_patch(VkCommandBuffer c, uint32_t which, Rgb background) const {
  run(c, which, groups_of(buffers.patches), 0, buffers.patches, background);
}

MovedPush DeviceRelighter::Impl::direct_push(const matrix::RelightLights& from) const {
  return {.world = tracer->world(),
          .lights = lights.address,
          .places = probes.address,
          .light = buffers.at_probe.address,
          .place_count = uint32_t(data.probe.size()),
          .light_count = uint32_t(from.punctual.size()),
          .first_group = 0};
}

/// True: shadow rays are so many that they go to the device in pieces of their own.
bool DeviceRelighter::Impl::has_many_rays(const matrix::RelightLights& from) const {
  return from.direct_at_probes.empty() &&
         uint64_t(data.probe.size()) * from.punctual.size() > kMostRaysAtOnce;
}

/// Direct light at the probes: by shadow rays, or as the caller has it.
void DeviceRelighter::Impl::light_probes(VkCommandBuffer c,
                                         const matrix::RelightLights& from) const {
  if (!from.direct_at_probes.empty()) {
    const VkBufferCopy all{0, 0, from.direct_at_probes.size() * sizeof(Rgb)};
    device.vk.vkCmdCopyBuffer(c, probes_sent.buffer.get(), buffers.at_probe.buffer.get(), 1, &all);
    return;
  }
  if (has_many_rays(from)) return;
  dispatch(c, direct, direct_push(from), groups_of(uint32_t(data.probe.size())));
}

/// product = F radiosity: up the hierarchy, across, and down.
void DeviceRelighter::Impl::multiply(VkCommandBuffer c) const {
  const auto per_depth = [&](uint32_t which, const DepthPart& depth) {
    run(c, which, groups_of(depth.count), depth.first, depth.count, {});
  };
  run(c, on_device::kSendLeaves, groups_of(buffers.clusters), 0, buffers.clusters, {});
  for (size_t d = buffers.depths.size(); d-- > 0;) per_depth(on_device::kSendUp, buffers.depths[d]);
  run(c, on_device::kReceiveFar, buffers.clusters, 0, buffers.clusters, {});
  for (size_t d = 1; d < buffers.depths.size(); ++d)
    per_depth(on_device::kHandDown, buffers.depths[d]);
  run(c, on_device::kReceiveLeaves, buffers.leaves, 0, buffers.leaves, {});
}

/// matrix::all_bounces()
void DeviceRelighter::Impl::sweep(VkCommandBuffer c, int sweeps) const {
  multiply(c);
  per_patch(c, on_device::kBeginSweeps);
  for (int k = 1; k < sweeps; ++k) {
    run(c, on_device::kPowers, buffers.coarse, 0, buffers.coarse, {});
    run(c, on_device::kLate, buffers.coarse, 0, buffers.coarse, {});
    per_patch(c, on_device::kForesee);
    multiply(c);
    per_patch(c, on_device::kEndSweep);
  }
}

/// matrix::irradiance_of()
void DeviceRelighter::Impl::bounce(VkCommandBuffer c) const {
  if (data.bounces == 0) return;
  if (buffers.block_rows > 0) {
    run(c, on_device::kBlocks, buffers.block_rows, 0, buffers.block_rows, {});
    return per_patch(c, on_device::kTakeProduct);
  }
  if (data.bounces < 0) return sweep(c, std::get<matrix::HierarchicalCodec>(data.codec).sweeps);
  for (int k = 0; k < data.bounces; ++k) {
    per_patch(c, on_device::kBounce);
    multiply(c);
    per_patch(c, on_device::kTakeProduct);
  }
}

DeviceRelighter::DeviceRelighter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
DeviceRelighter::DeviceRelighter(DeviceRelighter&&) noexcept = default;
DeviceRelighter& DeviceRelighter::operator=(DeviceRelighter&&) noexcept = default;
DeviceRelighter::~DeviceRelighter() = default;

Result<DeviceRelighter> DeviceRelighter::make(const gpu::Device& device,
                                              const matrix::RelightData& data) {
  std::unique_ptr<Impl> impl(new Impl{device, data, matrix::scene_of(data.occluders)});
  LUXEL_TRY(gpu::Commands commands, gpu::Commands::make(device));
  impl->commands.emplace(std::move(commands));
  impl->mean_emission = matrix::mean_emission_of(data);
  LUXEL_TRY(impl->buffers, upload_relight_data(*impl->commands, data));
  LUXEL_TRY(trace::DeviceRayTracer tracer, trace::DeviceRayTracer::build(device, impl->occluders));
  impl->tracer.emplace(std::move(tracer));
  static constexpr matrix::PatchPoint kNone{};
  const std::span<const matrix::PatchPoint> probes =
      data.probe.empty() ? std::span(&kNone, 1) : std::span<const matrix::PatchPoint>(data.probe);
  LUXEL_TRY(impl->probes,
            gpu::uploaded(*impl->commands, std::as_bytes(probes), "the buffer of probes"));
  LUXEL_TRY(impl->probes_sent, gpu::make_buffer(device, probes.size() * sizeof(Rgb),
                                                gpu::Access::from_host, "the buffer of probes"));
  LUXEL_TRY_STATUS(impl->make_pipelines());
  return DeviceRelighter(std::move(impl));
}

Status DeviceRelighter::update(const matrix::RelightLights& lights) {
  Impl& my = *impl_;
  LUXEL_CHECK(lights.emission.empty() || lights.emission.size() == my.data.material_name.size());
  LUXEL_CHECK(lights.direct_at_probes.empty() ||
              lights.direct_at_probes.size() == my.data.probe.size());
  const auto start = Clock::now();
  LUXEL_TRY_STATUS(my.send_lights(lights.punctual));
  my.send_materials(lights.emission);
  if (!lights.direct_at_probes.empty())
    std::memcpy(my.probes_sent.mapped, lights.direct_at_probes.data(),
                lights.direct_at_probes.size_bytes());
  if (my.has_many_rays(lights)) {
    LUXEL_TRY([[maybe_unused]] const double traced,
              gpu::run_groups(*my.commands, my.direct, my.direct_push(lights),
                              groups_of(uint32_t(my.data.probe.size())), my.direct_piece));
  }
  LUXEL_TRY_STATUS(my.commands->run([&](VkCommandBuffer c) {
    gpu::full_barrier(my.device, c);
    my.light_probes(c, lights);
    my.per_patch(c, on_device::kPatches, lights.background);
    my.bounce(c);
    my.per_patch(c, on_device::kFinish);
    my.run(c, on_device::kPlaces, groups_of(my.buffers.places), 0, my.buffers.places, {});
    gpu::full_barrier(my.device, c);
  }));
  my.seconds = seconds_since(start);
  return {};
}

Status DeviceRelighter::read(matrix::Relit& out) {
  Impl& my = *impl_;
  const auto read = [&](const gpu::Buffer& from, size_t count) {
    return gpu::downloaded<Rgb>(*my.commands, from, count, "the buffer of relit light");
  };
  LUXEL_TRY(out.direct, read(my.buffers.direct, my.data.size()));
  LUXEL_TRY(out.indirect, read(my.buffers.indirect, my.data.size()));
  LUXEL_TRY(out.indirect_at_points, read(my.buffers.at_place, my.buffers.places));
  return {};
}

VkDeviceAddress DeviceRelighter::indirect_at_points() const {
  return impl_->buffers.at_place.address;
}
double DeviceRelighter::seconds() const { return impl_->seconds; }

}  // namespace luxel::device
