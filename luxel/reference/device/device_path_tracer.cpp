#include "luxel/reference/device/device_path_tracer.h"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>

#include "luxel/base/check.h"
#include "luxel/gpu/pieces.h"
#include "luxel/reference/device/eye_push_shared.h"
#include "luxel/reference/device/path_buffers.h"
#include "luxel/reference/device/path_push_shared.h"
#include "luxel/reference/device/shaders/eye.comp.h"
#include "luxel/reference/device/shaders/paths.comp.h"
#include "luxel/reference/sums.h"
#include "luxel/scene/sides.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/transport/back_faces.h"

namespace luxel::reference {
namespace {

/// Threads that are under way at a time, at most, and about as many as there should be.
constexpr size_t kMostItems = size_t(1) << 18, kEnoughItems = size_t(1) << 16;
/// Paths that a thread follows before the next dispatch.
constexpr uint32_t kPathsAtATime = 4;

using on_device::EyePush, on_device::kPathThreads, on_device::PathPush, on_device::PathSums;

static_assert(sizeof(Receiver) == 36);  // as shaders/paths.comp reads it

/// Those of all paths of a receiver or a pixel.
struct AllPaths {
  Sums sums;
  uint64_t rays = 0;
  uint32_t back = 0, double_sided_back = 0, covered = 0;

  void add(const PathSums& some) {
    sums.add({some.r, some.g, some.b, some.l, some.r2, some.g2, some.b2, some.l2});
    rays += some.rays, covered += some.covered;
    back += some.back, double_sided_back += some.double_sided_back;
  }
};

/// The division of each receiver's or pixel's paths into `count` slices, a thread for each.
struct Slices {
  size_t count = 1;
  uint32_t samples_of_each = 1;
};
Slices slices_of(size_t receivers, int samples) {
  const auto s = size_t(samples);
  const size_t wanted = std::clamp<size_t>(kEnoughItems / std::max<size_t>(receivers, 1), 1, s);
  const size_t each = (s + wanted - 1) / wanted;
  return {(s + each - 1) / each, uint32_t(each)};
}

/// The paths of a receiver or pixel that a dispatch follows: the last slice may have fewer.
uint64_t paths_of(const PathPush& push, const Slices& slices) {
  uint64_t out = 0;
  for (size_t k = 0; k < slices.count; ++k) {
    const int64_t begin = int64_t(k) * slices.samples_of_each + push.first_sample;
    out += uint64_t(std::clamp<int64_t>(push.samples - begin, 0, push.sample_count));
  }
  return out;
}

std::string what_is_unknown(const scene::Scene& scene, const trace::RayTracer& tracer) {
  if (tracer.has_tints()) return "coloured glass";
  if (scene::scatters_light(scene)) return "surfaces that let scattered light through";
  for (const scene::PunctualLight& light : scene.lights)
    if (light.profile != scene::kNone) return "light profiles";
  return {};
}

}  // namespace

struct DevicePathTracer::Impl {
  const gpu::Device& device;
  std::optional<gpu::Commands> commands{};
  std::optional<trace::DeviceRayTracer> tracer{};
  PathBuffersOnDevice world{};
  gpu::Pipeline paths{}, eye{};
  gpu::PieceSize paths_piece{kPathThreads}, eye_piece{kPathThreads};
  gpu::Buffer sums{}, sums_back{}, hits{};

  using Take = std::function<void(size_t i, const AllPaths& paths)>;

  Status make_room(size_t items, bool with_hits);
  Result<gpu::Buffer> uploaded_bytes(std::span<const std::byte> bytes);
  Status follow_some(PathPush push, const Slices& slices, Progress& progress);
  Status follow_all(size_t count, const PathParams& params, PathPush push, const Take& take,
                    Progress& progress);
};

Status DevicePathTracer::Impl::make_room(size_t items, bool with_hits) {
  constexpr std::string_view kWhat = "the buffer of paths";
  using gpu::Access;
  LUXEL_TRY(sums, gpu::make_buffer(device, items * sizeof(PathSums), Access::device, kWhat));
  LUXEL_TRY(sums_back, gpu::make_buffer(device, items * sizeof(PathSums), Access::to_host, kWhat));
  const size_t bytes = with_hits ? items * sizeof(on_device::Hit) : 16;
  LUXEL_TRY(hits, gpu::make_buffer(device, bytes, Access::device, kWhat));
  return {};
}

Result<gpu::Buffer> DevicePathTracer::Impl::uploaded_bytes(std::span<const std::byte> bytes) {
  static constexpr std::array<std::byte, 16> kNone{};  // a buffer is never empty
  return gpu::uploaded(*commands, bytes.empty() ? std::span<const std::byte>(kNone) : bytes,
                       "the buffer of paths");
}

/// All paths of some items: their sums lie in sums_back then.
Status DevicePathTracer::Impl::follow_some(PathPush push, const Slices& slices,
                                           Progress& progress) {
  const size_t groups = (push.item_count + kPathThreads - 1) / kPathThreads;
  const bool picture = (push.flags & on_device::kPicture) != 0;
  LUXEL_TRY_STATUS(commands->run([&](VkCommandBuffer c) {
    device.vk.vkCmdFillBuffer(c, sums.buffer.get(), 0, VK_WHOLE_SIZE, 0);
  }));
  const uint32_t step = picture ? 1 : kPathsAtATime;
  for (uint32_t first = 0; first < slices.samples_of_each; first += step) {
    LUXEL_TRY_STATUS(stopped(progress));
    push.first_sample = first;
    push.sample_count = std::min(step, slices.samples_of_each - first);
    if (picture) {
      const EyePush look{.setup = push.setup,
                         .camera = push.camera,
                         .hits = push.eye_hits,
                         .seed = push.seed,
                         .first_pixel = push.first_item,
                         .item_count = push.item_count,
                         .slices = push.slices,
                         .samples_of_slice = push.samples_of_slice,
                         .samples = push.samples,
                         .first_sample = first,
                         .first_group = 0};
      LUXEL_TRY([[maybe_unused]] const double looked,
                gpu::run_groups(*commands, eye, look, groups, eye_piece, &progress));
    }
    LUXEL_TRY([[maybe_unused]] const double followed,
              gpu::run_groups(*commands, paths, push, groups, paths_piece, &progress));
    progress.advance(push.item_count / slices.count * paths_of(push, slices));
  }
  return gpu::copy_bytes(*commands, sums, sums_back, push.item_count * sizeof(PathSums));
}

/// Hands on what the paths of each of `count` receivers or pixels have summed to.
Status DevicePathTracer::Impl::follow_all(size_t count, const PathParams& params, PathPush push,
                                          const Take& take, Progress& progress) {
  if (count == 0) return {};
  const Slices slices = slices_of(count, params.samples);
  const size_t at_a_time = std::max<size_t>(kMostItems / slices.count, 1);
  LUXEL_TRY_STATUS(make_room(std::min(at_a_time, count) * slices.count,
                             (push.flags & on_device::kPicture) != 0));
  push.setup = world.setup.address, push.sums = sums.address, push.eye_hits = hits.address;
  push.seed = on_device::halves(params.seed);
  push.slices = uint32_t(slices.count), push.samples_of_slice = slices.samples_of_each;
  push.samples = uint32_t(params.samples), push.bounces = params.bounces;
  for (size_t first = 0; first < count; first += at_a_time) {
    const size_t some = std::min(at_a_time, count - first);
    push.first_item = uint32_t(first), push.item_count = uint32_t(some * slices.count);
    LUXEL_TRY_STATUS(follow_some(push, slices, progress));
    const auto* found = reinterpret_cast<const PathSums*>(sums_back.mapped);
    for (size_t i = 0; i < some; ++i) {
      AllPaths all;
      for (size_t k = i * slices.count; k < (i + 1) * slices.count; ++k) all.add(found[k]);
      take(first + i, all);
    }
  }
  return {};
}

DevicePathTracer::DevicePathTracer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
DevicePathTracer::DevicePathTracer(DevicePathTracer&&) noexcept = default;
DevicePathTracer& DevicePathTracer::operator=(DevicePathTracer&&) noexcept = default;
DevicePathTracer::~DevicePathTracer() = default;

Result<DevicePathTracer> DevicePathTracer::make(const gpu::Device& device,
                                                const scene::Scene& scene,
                                                const trace::RayTracer& tracer) {
  const std::string unknown = what_is_unknown(scene, tracer);
  if (!unknown.empty())
    return fail(
        ErrorCode::unsupported,
        "the device cannot trace paths with {}, which the scene has: trace them on the processor",
        unknown);
  if (!device.has_doubles)
    return fail(ErrorCode::unsupported, "{} has no double precision, which paths need",
                device.name);
  std::unique_ptr<Impl> impl(new Impl{device});
  LUXEL_TRY(gpu::Commands commands, gpu::Commands::make(device));
  impl->commands.emplace(std::move(commands));
  LUXEL_TRY(trace::DeviceRayTracer on_device, trace::DeviceRayTracer::build(device, scene));
  impl->tracer.emplace(std::move(on_device));
  LUXEL_TRY(impl->world, upload_world(*impl->commands, *impl->tracer, traced_scene(scene, tracer)));
  const trace::HierarchyKind kind = impl->tracer->kind();
  const std::vector<uint32_t> constants{impl->tracer->shader_constant()};
  LUXEL_TRY(impl->paths, gpu::make_compute_pipeline(device, paths_comp(kind),
                                                    {sizeof(PathPush), {}}, constants));
  LUXEL_TRY(impl->eye,
            gpu::make_compute_pipeline(device, eye_comp(kind), {sizeof(EyePush), {}}, constants));
  return DevicePathTracer(std::move(impl));
}

Result<TexelPaths> DevicePathTracer::irradiance(const Receivers& receivers,
                                                const PathParams& params, Progress& progress) {
  Impl& my = *impl_;
  const size_t count = receivers.size();
  LUXEL_CHECK(params.samples >= 1 && !params.is_one_place);
  LUXEL_CHECK(receivers.normal.size() == receivers.position.size());
  LUXEL_CHECK(receivers.geometric_normal.size() == receivers.position.size());
  std::vector<Receiver> places;
  for (size_t k = 0; k < receivers.position.size(); ++k)
    places.push_back({receivers.position[k], receivers.normal[k], receivers.geometric_normal[k]});
  LUXEL_TRY(const gpu::Buffer at, my.uploaded_bytes(std::as_bytes(std::span(places))));
  LUXEL_TRY(const gpu::Buffer first, my.uploaded_bytes(std::as_bytes(receivers.first)));
  PathPush push{};
  push.places = at.address, push.first_place = first.address;
  push.flags = receivers.first.empty() ? on_device::kOnePlaceEach : 0;
  TexelPaths out;
  out.irradiance.resize(count), out.standard_error.resize(count), out.luminance_error.resize(count);
  out.met_back.resize(count), out.met_double_sided_back.resize(count), out.enclosed.resize(count);
  const double n = params.samples;
  double sum = 0;
  const auto take = [&](size_t i, const AllPaths& s) {
    out.irradiance[i] = mean_of(s.sums, n) * kPi;
    out.standard_error[i] = error_of(s.sums, n) * kPi;
    out.luminance_error[i] = float(standard_error(s.sums.l, s.sums.l2, n)) * kPi;
    out.met_back[i] = s.back, out.met_double_sided_back[i] = s.double_sided_back;
    out.enclosed[i] = transport::is_enclosed(
        transport::BackFaces{params.samples, int(s.back), int(s.double_sided_back)});
    out.rays += s.rays, sum += double(luminance(out.irradiance[i]));
  };
  progress.begin("trace paths", uint64_t(count) * uint64_t(params.samples));
  LUXEL_TRY_STATUS(my.follow_all(count, params, push, take, progress));
  out.relative_error = relative_error(out.luminance_error, sum);
  return out;
}

Result<Picture> DevicePathTracer::radiance(const scene::Camera& camera, int width, int height,
                                           const PathParams& params, Progress& progress) {
  Impl& my = *impl_;
  LUXEL_CHECK(params.samples >= 1 && width > 0 && height > 0);
  const trace::CameraRays rays(camera, width, height);
  const on_device::Camera values{rays.eye,   rays.right,  rays.up,          rays.forward,
                                 rays.width, rays.height, rays.orthographic};
  LUXEL_TRY(const gpu::Buffer seen_by, my.uploaded_bytes(std::as_bytes(std::span(&values, 1))));
  PathPush push{};
  push.camera = seen_by.address, push.flags = on_device::kPicture;
  const size_t count = size_t(width) * size_t(height);
  Picture out;
  out.radiance = image::Image(width, height, 4);
  out.luminance_error.resize(count);
  const double n = params.samples;
  double sum = 0;
  const auto take = [&](size_t i, const AllPaths& s) {
    const int x = int(i % size_t(width)), y = int(i / size_t(width));
    out.radiance.set_rgb(x, y, mean_of(s.sums, n));
    out.radiance.at(x, y)[3] = float(double(s.covered) / n);
    out.luminance_error[i] = float(standard_error(s.sums.l, s.sums.l2, n));
    out.rays += s.rays, sum += double(luminance(out.radiance.rgb(x, y)));
  };
  progress.begin("trace paths", uint64_t(count) * uint64_t(params.samples));
  LUXEL_TRY_STATUS(my.follow_all(count, params, push, take, progress));
  out.relative_error = relative_error(out.luminance_error, sum);
  return out;
}

namespace {

class DevicePaths final : public PathDevice {
 public:
  explicit DevicePaths(const gpu::Device& device) : device_(device) {}

  Result<TexelPaths> irradiance(const scene::Scene& scene, const trace::RayTracer& tracer,
                                const Receivers& receivers, const PathParams& params,
                                Progress& progress) override {
    LUXEL_TRY(DevicePathTracer paths, DevicePathTracer::make(device_, scene, tracer));
    return paths.irradiance(receivers, params, progress);
  }

  Result<Picture> radiance(const scene::Scene& scene, const trace::RayTracer& tracer,
                           const scene::Camera& camera, int width, int height,
                           const PathParams& params, Progress& progress) override {
    LUXEL_TRY(DevicePathTracer paths, DevicePathTracer::make(device_, scene, tracer));
    return paths.radiance(camera, width, height, params, progress);
  }

 private:
  const gpu::Device& device_;
};

}  // namespace

std::unique_ptr<PathDevice> path_device(const gpu::Device& device) {
  return std::make_unique<DevicePaths>(device);
}

}  // namespace luxel::reference
