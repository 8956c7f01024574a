#include "luxel/solve/device/device_look.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <optional>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/solve/device/device_surroundings.h"
#include "luxel/solve/device/look_shared.h"
#include "luxel/solve/device/shaders/hemicubes.comp.h"
#include "luxel/solve/hemicube/item_buffer.h"
#include "luxel/trace/vulkan/device_pictures.h"
#include "luxel/trace/vulkan/device_ray_tracer.h"

namespace luxel::device {
namespace {

/// The weights of all pixels sum to this. A share is a sum of weights, divided by it.
constexpr double kWholeWeight = 2147483648.0;  // 2^31
/// Shares that lie on the device at a time, and here: 64 MB, or those of one tile of viewpoints.
constexpr size_t kSharesAtATime = size_t(1) << 24;
/// Viewpoints at a time, at most, and their rays: progress moves on after them.
constexpr size_t kMostAtATime = 4096, kMostRaysAtATime = size_t(1) << 26;

using on_device::LookPush, on_device::LookSetup, on_device::SeenTriangle;

/// Factors as whole numbers: what rounding takes from one the next gets.
std::vector<on_device::Pixel> device_pixels(std::span<const hemicube::Pixel> pixels) {
  std::vector<on_device::Pixel> out;
  double below = 0;
  uint64_t given = 0;
  for (const hemicube::Pixel& p : pixels) {
    below += double(p.factor);
    const auto upto = uint64_t(std::llround(std::min(below, 1.0) * kWholeWeight));
    out.push_back({p.direction, p.factor, uint32_t(upto - given)});
    given = upto;
  }
  return out;
}

/// Triangles of a scene as hemicubes see them, and pictures of their emission.
struct SeenScene {
  std::vector<SeenTriangle> triangles;
  std::vector<on_device::PlacedPicture> pictures;
  std::vector<uint32_t> texels;
};

/// Adds a triangle of an instance.
void add_seen(const hemicube::Senders& s, uint32_t instance, uint32_t triangle,
              trace::DevicePictures& pictures, SeenScene& out) {
  const scene::Mesh& mesh = s.scene.meshes[s.scene.instances[instance].mesh];
  const scene::Material& m = s.scene.materials[mesh.triangle_material[triangle]];
  const bool shines = s.emission_by_pixels && max_component(m.emission) > 0;
  const bool is_sheet = !mesh.other_side.empty() && mesh.other_side[triangle] != scene::kNone;
  out.triangles.push_back(
      {.first_root = s.mesh.first_root[out.triangles.size()],
       .grid = s.mesh.grid[instance],
       .other_side = is_sheet ? s.mesh.first_triangle[instance] + mesh.other_side[triangle]
                              : on_device::kNoTriangle,
       .flags = (scene::reflects_from_behind(m) ? on_device::kTwoSided : 0) |
                (shines ? on_device::kEmissive : 0),
       .emission = m.emission,
       .picture = 0});
  if (!shines || m.emission_texture.texture == scene::kNone) return;
  out.pictures.push_back(pictures.placed(mesh, triangle, m.emission_texture));
  out.triangles.back().picture = uint32_t(out.pictures.size());
}

SeenScene seen_scene(const hemicube::Senders& s) {
  SeenScene out;
  trace::DevicePictures pictures(s.scene, out.texels);
  for (uint32_t i = 0; i < s.scene.instances.size(); ++i) {
    const size_t count = s.scene.meshes[s.scene.instances[i].mesh].triangles.size();
    for (uint32_t t = 0; t < count; ++t) add_seen(s, i, t, pictures, out);
  }
  return out;
}

std::vector<on_device::Node> device_nodes(const hemicube::Senders& s) {
  const bool per_vertex = s.receivers.kind == hemicube::ElementKind::vertex;
  std::vector<on_device::Node> out;
  out.reserve(s.mesh.nodes.size());
  for (uint32_t i = 0; i < s.mesh.nodes.size(); ++i) {
    const hemicube::Node& node = s.mesh.nodes[i];
    on_device::Node& to = out.emplace_back();
    for (size_t k = 0; k < 3; ++k) to.at[k] = {node.at[k].u, node.at[k].v};
    to.child = node.child;
    if (per_vertex)
      to.element = node.vertex;
    else
      to.element = {node.child == 0 ? s.receivers.leaf_of_node[i] : 0, 0, 0};
  }
  return out;
}

on_device::Viewpoint device_viewpoint(const hemicube::Viewpoint& from) {
  const Frame frame = hemicube::frame_of_cube(from.normal);
  return {frame.tangent, frame.bitangent, frame.normal, from.position, from.geometric_normal};
}

template <class T>
Result<gpu::Buffer> uploaded(gpu::Commands& commands, const std::vector<T>& values) {
  return gpu::uploaded(commands, std::as_bytes(std::span(values)), "the buffer of hemicubes");
}

/// Commands and buffers for looking on the device.
struct Looking {
  gpu::Commands& commands;
  size_t elements, at_a_time;
  gpu::Buffer triangles{}, nodes{}, pixels{}, setup{};
  gpu::Buffer pictures{}, texels{}, linear_of_byte{};
  DeviceSurroundings around{};
  gpu::Buffer from{}, from_sent{}, views{}, views_back{}, shares{}, shares_back{};
};

/// The shader that looks: made once for a scene.
struct LookShader {
  gpu::Pipeline pipeline;
  gpu::PieceSize piece{16};  ///< of viewpoints
};
Result<LookShader> look_shader(const trace::DeviceRayTracer& tracer) {
  LookShader out;
  LUXEL_TRY(out.pipeline,
            gpu::make_compute_pipeline(tracer.device(), hemicubes_comp(tracer.kind()),
                                       {sizeof(LookPush), {}}, {tracer.shader_constant()}));
  return out;
}

Status make_room(Looking& l) {
  const gpu::Device& device = l.commands.device();
  constexpr std::string_view kWhat = "the buffer of hemicubes";
  const size_t n = l.at_a_time, shares = n * l.elements * sizeof(uint32_t);
  using gpu::Access;
  LUXEL_TRY(l.from,
            gpu::make_buffer(device, n * sizeof(on_device::Viewpoint), Access::device, kWhat));
  LUXEL_TRY(l.from_sent,
            gpu::make_buffer(device, n * sizeof(on_device::Viewpoint), Access::from_host, kWhat));
  LUXEL_TRY(l.views, gpu::make_buffer(device, n * sizeof(on_device::View), Access::device, kWhat));
  LUXEL_TRY(l.views_back,
            gpu::make_buffer(device, n * sizeof(on_device::View), Access::to_host, kWhat));
  LUXEL_TRY(l.shares, gpu::make_buffer(device, shares, Access::device, kWhat));
  LUXEL_TRY(l.shares_back, gpu::make_buffer(device, shares, Access::to_host, kWhat));
  return {};
}

Status prepare(const hemicube::Senders& s, const trace::DeviceRayTracer& tracer,
               std::span<const hemicube::Pixel> pixels, Looking& l) {
  const SeenScene seen = seen_scene(s);
  constexpr std::string_view kPictures = "the buffer of pictures that shine";
  LUXEL_TRY(l.triangles, uploaded(l.commands, seen.triangles));
  LUXEL_TRY(l.pictures, gpu::uploaded_or_one(l.commands, seen.pictures, kPictures));
  LUXEL_TRY(l.texels, gpu::uploaded_or_one(l.commands, seen.texels, kPictures));
  LUXEL_TRY(l.linear_of_byte,
            gpu::uploaded_or_one(l.commands, trace::linear_of_bytes(), kPictures));
  LUXEL_TRY(l.nodes, uploaded(l.commands, device_nodes(s)));
  LUXEL_TRY(l.pixels, uploaded(l.commands, device_pixels(pixels)));
  LUXEL_TRY(l.around, upload_surroundings(l.commands, s.scene.environment, s.around));
  const LookSetup setup{.world = tracer.world(),
                        .triangles = l.triangles.address,
                        .nodes = l.nodes.address,
                        .pixels = l.pixels.address,
                        .around = l.around.values.address,
                        .pictures = l.pictures.address,
                        .texels = l.texels.address,
                        .linear_of_byte = l.linear_of_byte.address,
                        .pixel_count = uint32_t(pixels.size()),
                        .element_count = uint32_t(l.elements),
                        .per_vertex = s.receivers.kind == hemicube::ElementKind::vertex};
  LUXEL_TRY(l.setup, uploaded(l.commands, std::vector{setup}));
  return make_room(l);
}

/// Looks from some viewpoints: what they see lies in views_back and shares_back then. Returns the
/// seconds.
Result<double> look_from(std::span<const hemicube::Viewpoint> from, LookShader& shader, Looking& l,
                         const Progress& progress) {
  const gpu::Device& device = l.commands.device();
  auto* sent = reinterpret_cast<on_device::Viewpoint*>(l.from_sent.mapped);
  for (size_t i = 0; i < from.size(); ++i) sent[i] = device_viewpoint(from[i]);
  LUXEL_TRY_STATUS(
      gpu::copy_bytes(l.commands, l.from_sent, l.from, from.size() * sizeof(on_device::Viewpoint)));
  LUXEL_TRY_STATUS(l.commands.run([&](VkCommandBuffer c) {
    device.vk.vkCmdFillBuffer(c, l.shares.buffer.get(), 0, VK_WHOLE_SIZE, 0);
  }));
  const LookPush push{l.setup.address, l.from.address, l.views.address, l.shares.address, 0};
  LUXEL_TRY(const double seconds, gpu::run_groups(l.commands, shader.pipeline, push, from.size(),
                                                  shader.piece, &progress));
  LUXEL_TRY_STATUS(
      gpu::copy_bytes(l.commands, l.views, l.views_back, from.size() * sizeof(on_device::View)));
  LUXEL_TRY_STATUS(gpu::copy_bytes(l.commands, l.shares, l.shares_back,
                                   from.size() * l.elements * sizeof(uint32_t)));
  return seconds;
}

/// Reads back the view from the k-th viewpoint.
void take_view(const Looking& l, size_t k, hemicube::View& view) {
  const on_device::View& found = reinterpret_cast<const on_device::View*>(l.views_back.mapped)[k];
  view.emitted = found.emitted;
  view.back = float(double(found.back) / kWholeWeight);
  view.two_sided_back = float(double(found.two_sided_back) / kWholeWeight);
  view.element.clear(), view.share.clear();
  const auto* shares = reinterpret_cast<const uint32_t*>(l.shares_back.mapped) + k * l.elements;
  for (uint32_t i = 0; i < l.elements; ++i) {
    if (shares[i] == 0) continue;
    view.element.push_back(i), view.share.push_back(float(double(shares[i]) / kWholeWeight));
  }
}

/// Hands views [first, first + count) on, groups of neighbours in order. Returns what `done` has
/// returned first that is no success.
Status hand_on(const Looking& l, size_t first, size_t count, const hemicube::OnView& done,
               Progress& progress) {
  std::mutex mutex;
  Status status;
  parallel_for(count, hemicube::kTileElements, [&](size_t begin, size_t end) {
    hemicube::View view;
    for (size_t k = begin; k < end && !progress.cancelled(); ++k) {
      take_view(l, k, view);
      const Status kept = done(first + k, view);
      progress.advance(1);
      if (kept) continue;
      const std::lock_guard lock(mutex);
      if (status) status = kept;
      progress.request_cancel();
    }
  });
  if (!status) return status;
  return stopped(progress);
}

class DeviceLook final : public hemicube::LookDevice {
 public:
  explicit DeviceLook(const gpu::Device& device) : device_(&device) {}

  Status begin(const scene::Scene& scene) override {
    tracer_.reset();
    LUXEL_TRY(gpu::Commands commands, gpu::Commands::make(*device_));
    commands_.emplace(std::move(commands));
    LUXEL_TRY(trace::DeviceRayTracer tracer, trace::DeviceRayTracer::build(*device_, scene));
    tracer_.emplace(std::move(tracer));
    LUXEL_TRY(shader_, look_shader(*tracer_));
    return {};
  }

  void forget() override { tracer_.reset(), shader_ = {}; }

  Result<hemicube::LookSeconds> look(const hemicube::Senders& senders,
                                     std::span<const hemicube::Viewpoint> from,
                                     const hemicube::LookParams& params,
                                     const hemicube::OnView& done, Progress& progress) override {
    LUXEL_CHECK(tracer_ && senders.receivers.size() > 0);
    LUXEL_TRY(const std::vector<hemicube::Pixel> pixels,
              hemicube::pixels_in_tiles(params.resolution, progress));
    constexpr size_t kTile = hemicube::kTileElements;
    const size_t elements = senders.receivers.size();
    const size_t at_a_time = std::min({kSharesAtATime / elements, kMostAtATime,
                                       kMostRaysAtATime / hemicube::pixels_of(params.resolution)});
    const size_t tiles = std::max<size_t>(at_a_time / kTile, 1);
    Looking l{*commands_, elements, std::min(tiles * kTile, std::max(from.size(), size_t(1)))};
    LUXEL_TRY_STATUS(prepare(senders, *tracer_, pixels, l));
    progress.begin("hemicubes", from.size());
    hemicube::LookSeconds out;
    for (size_t first = 0; first < from.size(); first += l.at_a_time) {
      LUXEL_TRY_STATUS(stopped(progress));
      const size_t count = std::min(l.at_a_time, from.size() - first);
      LUXEL_TRY(const double seconds, look_from(from.subspan(first, count), shader_, l, progress));
      out.visibility += seconds;
      LUXEL_TRY_STATUS(hand_on(l, first, count, done, progress));
    }
    return out;
  }

 private:
  const gpu::Device* device_;
  std::optional<gpu::Commands> commands_;
  std::optional<trace::DeviceRayTracer> tracer_;  ///< of the last begin()
  LookShader shader_;
};

}  // namespace

std::unique_ptr<hemicube::LookDevice> look_device(const gpu::Device& device) {
  return std::make_unique<DeviceLook>(device);
}

}  // namespace luxel::device
