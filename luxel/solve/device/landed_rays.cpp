#include "luxel/solve/device/landed_rays.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "luxel/base/check.h"
#include "luxel/base/clock.h"
#include "luxel/base/parallel.h"
#include "luxel/gpu/pieces.h"
#include "luxel/solve/device/landings.h"
#include "luxel/solve/device/shaders/escaped_light.comp.h"
#include "luxel/solve/device/shaders/landed_rays_binary.comp.h"
#include "luxel/solve/device/shaders/landed_rays_wide.comp.h"
#include "luxel/solve/gather/rays/ray_tile.h"
#include "luxel/solve/gather/trace/open_rays.h"
#include "luxel/solve/gather/trace/scene_of_rays.h"

namespace luxel::device {
namespace {

// Structs of landed_rays.glsl and escaped_light.comp.

struct DeviceOpenRay {
  uint32_t element, place, sample;
  trace::DeviceHit hit;
};
static_assert(sizeof(DeviceOpenRay) == 28);

/// What OpenRays begins with.
struct OpenHead {
  uint32_t count = 0, capacity = 0;
};

struct EndCounts {
  uint32_t escaped = 0, dark_back = 0, lit_back = 0;
};

struct Setup {
  trace::DeviceWorld world;
  VkDeviceAddress elements, plain, landings, mixed, counts, open;
  uint32_t seed_low, seed_high;
  uint32_t element_count, samples, resolution, has_mixed;
};
static_assert(sizeof(Setup) == 40 + 48 + 24);

struct LandPush {
  VkDeviceAddress setup, hits;
  uint32_t first_tile, first_group = 0;
};

struct DeviceSurroundings {
  Rgb background;
  float limit;
  int32_t width, height;
  float rotation_rad;
  uint32_t unused = 0;
  VkDeviceAddress pixels;
};
static_assert(sizeof(DeviceSurroundings) == 40);

struct LightPush {
  VkDeviceAddress around, elements, plain, hits, light;
  uint32_t seed_low, seed_high;
  uint32_t element_count, samples;
  uint32_t first_tile, first_group = 0;
};
static_assert(sizeof(LightPush) == 64 && sizeof(gather::EscapedLight) == 20);

/// What a round of rays needs on the device.
struct Round {
  const DeviceScene& scene;
  uint32_t samples;
  uint64_t seed;  ///< of all elements
  ElementBuffers from{};
  gpu::Buffer landings{}, mixed{}, counts{};
  gpu::Buffer open{}, open_to_host{};  ///< OpenHead, and as many DeviceOpenRay as have room
  uint32_t open_capacity = 0;
  gpu::Pipeline land{};
  gpu::PieceSize land_piece{kTogether}, escaped_piece{kTogether};
  // Only where light comes from around.
  gpu::Buffer around{}, pixels{}, light{};
  gpu::Pipeline escaped{};

  const gpu::Device& device() const { return scene.tracer.device(); }
  size_t element_count() const { return scene.in.elements.size(); }
  bool is_dark_around() const { return light.size == 0; }
};

template <class T>
Result<gpu::Buffer> uploaded(gpu::Commands& commands, std::span<const T> values,
                             std::string_view what) {
  static constexpr T kNone{};  // a buffer is never empty
  if (values.empty()) values = {&kNone, 1};
  return gpu::uploaded(commands, std::as_bytes(values), what);
}

/// The first `count` values of a buffer.
template <class T>
Result<std::vector<T>> downloaded(gpu::Commands& commands, const gpu::Buffer& from, size_t count) {
  LUXEL_TRY(const gpu::Buffer to,
            gpu::make_buffer(commands.device(), count * sizeof(T), gpu::Access::to_host,
                             "the buffer of what comes back"));
  LUXEL_TRY_STATUS(gpu::copy_bytes(commands, from, to, to.size));
  std::vector<T> out(count);
  std::memcpy(out.data(), to.mapped, to.size);
  return out;
}

Status make_room_for_open(uint64_t capacity, Round& round) {
  round.open = {}, round.open_to_host = {};
  const uint64_t bytes = sizeof(OpenHead) + capacity * sizeof(DeviceOpenRay);
  constexpr std::string_view kWhat = "the buffer of rays that the processor ends";
  LUXEL_TRY(round.open, gpu::make_buffer(round.device(), bytes, gpu::Access::device, kWhat));
  LUXEL_TRY(round.open_to_host,
            gpu::make_buffer(round.device(), bytes, gpu::Access::to_host, kWhat));
  round.open_capacity = uint32_t(capacity);
  return {};
}

/// Whether light comes from around at all.
bool shines(const scene::Scene& scene, const light::Surroundings& around) {
  return !scene.environment.empty() || max_component(around.background) > 0;
}

Status prepare_surroundings(Round& round) {
  const scene::Environment& map = round.scene.in.scene.environment;
  const light::Surroundings& around = round.scene.in.lights.around;
  if (!shines(round.scene.in.scene, around)) return {};
  gpu::Commands& commands = round.scene.commands;
  constexpr std::string_view kWhat = "the buffer of the surroundings";
  LUXEL_TRY(round.pixels, uploaded(commands, std::span<const Rgb>(map.radiance), kWhat));
  const DeviceSurroundings values{.background = around.background,
                                  .limit = around.limit,
                                  .width = map.empty() ? 0 : map.width,
                                  .height = map.empty() ? 0 : map.height,
                                  .rotation_rad = map.rotation_rad,
                                  .pixels = round.pixels.address};
  LUXEL_TRY(round.around, uploaded(commands, std::span(&values, 1), kWhat));
  LUXEL_TRY(round.light,
            gpu::make_buffer(round.device(), round.element_count() * sizeof(gather::EscapedLight),
                             gpu::Access::device, "the buffer of the sky's light"));
  LUXEL_TRY(round.escaped, gpu::make_compute_pipeline(round.device(), escaped_light_comp,
                                                      {sizeof(LightPush), {}}));
  return {};
}

Status prepare(const gather::SceneOfRays& rays, Round& round) {
  const gather::TraceScene& in = round.scene.in;
  gpu::Commands& commands = round.scene.commands;
  LUXEL_TRY(round.from, element_buffers(commands, in.elements, rays.diagonal_m(), round.samples));
  const std::vector<Landing> landings = landings_of(rays.rays());
  LUXEL_TRY(round.landings, uploaded(commands, std::span(landings), "the buffer of the lightmap"));
  std::span<const uint64_t> mixed;
  if (in.sides) mixed = in.sides->mixed;
  LUXEL_TRY(round.mixed, uploaded(commands, mixed, "the buffer of walls in the lightmap"));
  LUXEL_TRY(round.counts,
            gpu::make_buffer(round.device(), round.element_count() * sizeof(EndCounts),
                             gpu::Access::device, "the buffer of counts"));
  const bool wide = round.scene.tracer.kind() == trace::HierarchyKind::wide;
  LUXEL_TRY(round.land,
            gpu::make_compute_pipeline(
                round.device(),
                wide ? gpu::Spirv(landed_rays_wide_comp) : gpu::Spirv(landed_rays_binary_comp),
                {sizeof(LandPush), {}}, {uint32_t(round.scene.tracer.lets_light_through())}));
  return prepare_surroundings(round);
}

/// The buffer of what shaders are told of the round.
Result<gpu::Buffer> setup_of(const Round& round) {
  const bool has_mixed = round.scene.in.sides && !round.scene.in.sides->mixed.empty();
  const Setup values{.world = round.scene.tracer.world(),
                     .elements = round.from.elements.address,
                     .plain = round.from.samples.address,
                     .landings = round.landings.address,
                     .mixed = round.mixed.address,
                     .counts = round.counts.address,
                     .open = round.open.address,
                     .seed_low = uint32_t(round.seed),
                     .seed_high = uint32_t(round.seed >> 32),
                     .element_count = uint32_t(round.element_count()),
                     .samples = round.samples,
                     .resolution = uint32_t(round.scene.in.atlas.resolution),
                     .has_mixed = has_mixed};
  return uploaded(round.scene.commands, std::span(&values, 1), "the buffer of a round's settings");
}

/// Counts of a chunk's elements and the list of open rays begin anew.
Status reset(const Round& round, const LandedChunk& chunk) {
  const size_t first = chunk.first_tile * kTogether;
  const size_t count = std::min(chunk.tile_count * kTogether, round.element_count() - first);
  const OpenHead head{0, round.open_capacity};
  return round.scene.commands.run([&](VkCommandBuffer c) {
    const auto& vk = round.device().vk;
    gpu::full_barrier(round.device(), c);
    vk.vkCmdFillBuffer(c, round.counts.buffer.get(), first * sizeof(EndCounts),
                       count * sizeof(EndCounts), 0);
    vk.vkCmdUpdateBuffer(c, round.open.buffer.get(), 0, sizeof head, &head);
  });
}

/// The number of rays that the last run has left open.
Result<uint32_t> open_count(const Round& round) {
  LUXEL_TRY_STATUS(
      gpu::copy_bytes(round.scene.commands, round.open, round.open_to_host, sizeof(OpenHead)));
  OpenHead head;
  std::memcpy(&head, round.open_to_host.mapped, sizeof head);
  return head.count;
}

Status take_open(const Round& round, uint32_t count, std::vector<DeviceOpenRay>& out) {
  if (count == 0) return {};
  const size_t bytes = count * sizeof(DeviceOpenRay);
  LUXEL_TRY_STATUS(gpu::copy_bytes(round.scene.commands, round.open, round.open_to_host,
                                   sizeof(OpenHead) + bytes));
  const size_t before = out.size();
  out.resize(before + count);
  std::memcpy(out.data() + before, round.open_to_host.mapped + sizeof(OpenHead), bytes);
  return {};
}

/// Traces a chunk's rays once, and returns the seconds.
Result<double> trace_chunk(const LandedChunk& chunk, Round& round) {
  LUXEL_TRY_STATUS(reset(round, chunk));
  LUXEL_TRY(const gpu::Buffer setup, setup_of(round));
  LandPush push{setup.address, chunk.hits.address, uint32_t(chunk.first_tile)};
  return gpu::run_in_pieces(round.scene.commands, chunk.tile_count * gather::kCells,
                            round.device().limits.maxComputeWorkGroupCount[0], round.land_piece,
                            [&](VkCommandBuffer c, size_t first, size_t count) {
                              push.first_group = uint32_t(first);
                              gpu::bind(round.device(), c, round.land, push);
                              round.device().vk.vkCmdDispatch(c, uint32_t(count), 1, 1);
                            });
}

/// Finds where a chunk's rays land. Those that the device leaves open are added to `open`. Returns
/// the seconds on the device.
Result<double> land_chunk(const LandedChunk& chunk, Round& round,
                          std::vector<DeviceOpenRay>& open) {
  LUXEL_TRY(double seconds, trace_chunk(chunk, round));
  LUXEL_TRY(uint32_t count, open_count(round));
  if (count > round.open_capacity) {
    // The next chunks may leave a few more open.
    LUXEL_TRY_STATUS(make_room_for_open(count + count / 4, round));
    LUXEL_TRY(const double again, trace_chunk(chunk, round));
    seconds += again;
    LUXEL_TRY(const uint32_t now, open_count(round));
    LUXEL_CHECK(now == count);
  }
  LUXEL_TRY_STATUS(take_open(round, count, open));
  return seconds;
}

/// Adds up what a chunk's escaped rays see. Returns the seconds.
Result<double> light_of_escaped(const LandedChunk& chunk, Round& round) {
  if (round.is_dark_around()) return 0.0;
  LightPush push{.around = round.around.address,
                 .elements = round.from.elements.address,
                 .plain = round.from.samples.address,
                 .hits = chunk.hits.address,
                 .light = round.light.address,
                 .seed_low = uint32_t(round.seed),
                 .seed_high = uint32_t(round.seed >> 32),
                 .element_count = uint32_t(round.element_count()),
                 .samples = round.samples,
                 .first_tile = uint32_t(chunk.first_tile)};
  return gpu::run_in_pieces(round.scene.commands, chunk.tile_count,
                            round.device().limits.maxComputeWorkGroupCount[0], round.escaped_piece,
                            [&](VkCommandBuffer c, size_t first, size_t count) {
                              push.first_group = uint32_t(first);
                              gpu::bind(round.device(), c, round.escaped, push);
                              round.device().vk.vkCmdDispatch(c, uint32_t(count), 1, 1);
                            });
}

/// Notes what rays met, of those that the device has not left open, and what they saw outside.
Status take_counts(const Round& round, gather::TracedHits& hits) {
  const size_t n = round.element_count();
  LUXEL_TRY(const auto counts, downloaded<EndCounts>(round.scene.commands, round.counts, n));
  std::vector<gather::EscapedLight> light;
  if (!round.is_dark_around()) {
    LUXEL_TRY(light, downloaded<gather::EscapedLight>(round.scene.commands, round.light, n));
  }
  for (size_t i = 0; i < n; ++i) {
    hits.samples[i] = hits.counted[i] = uint16_t(round.samples);
    hits.escaped[i] = uint16_t(counts[i].escaped);
    hits.met_back[i] = uint16_t(counts[i].dark_back);
    hits.met_double_sided_back[i] = uint16_t(counts[i].lit_back);
    if (light.empty()) continue;
    hits.sky[i] = light[i].sum, hits.sky_luminance2[i] = light[i].luminance2;
    hits.sky_first_less_second[i] = luminance(light[i].sum) - 2 * light[i].second_luminance;
  }
  hits.rays += n * round.samples;
  return {};
}

/// Open rays in the order of elements, and of each element's rays; the device leaves them in any.
std::vector<gather::OpenRay> in_order(const Round& round, std::span<const DeviceOpenRay> open) {
  std::vector<size_t> first(round.element_count() + 1);
  for (const DeviceOpenRay& ray : open) ++first[ray.element + 1];
  for (size_t i = 0; i < round.element_count(); ++i) first[i + 1] += first[i];
  std::vector<uint32_t> order(open.size());
  std::vector<size_t> next = first;
  for (uint32_t k = 0; k < open.size(); ++k) order[next[open[k].element]++] = k;
  std::vector<gather::OpenRay> out(open.size());
  parallel_for(round.element_count(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto own = std::span(order).subspan(first[i], first[i + 1] - first[i]);
      std::ranges::sort(own, {}, [&](uint32_t k) { return open[k].place; });
      for (size_t at = first[i]; at < first[i + 1]; ++at) {
        const DeviceOpenRay& ray = open[order[at]];
        out[at] = {ray.element, ray.sample, round.scene.tracer.hit_of(ray.hit)};
      }
    }
  });
  return out;
}

/// Sends the device the hits of rays that the processor has ended.
Status keep_more(const Round& round, std::span<const gather::HitTile> tiles, LandedRays& out) {
  std::vector<uint32_t> ends;
  std::vector<gather::StoredHit> hits;
  for (const gather::HitTile& tile : tiles) {
    for (const uint32_t end : tile.end) ends.push_back(uint32_t(hits.size()) + end);
    hits.insert(hits.end(), tile.entries.begin(), tile.entries.end());
  }
  LUXEL_CHECK(ends.size() == round.element_count() && hits.size() <= UINT32_MAX);
  constexpr std::string_view kWhat = "the buffer of hits";
  LUXEL_TRY(out.ends, uploaded(round.scene.commands, std::span<const uint32_t>(ends), kWhat));
  LUXEL_TRY(out.more,
            uploaded(round.scene.commands, std::span<const gather::StoredHit>(hits), kWhat));
  return {};
}

}  // namespace

Result<LandedRays> land_rays(const DeviceScene& scene, const LandParams& land,
                             const gather::TraceParams& params, gather::TracedHits& hits,
                             LandedSeconds& seconds, Progress& progress) {
  const size_t n = scene.in.elements.size();
  const auto samples = uint64_t(land.samples);
  LUXEL_CHECK(n > 0 && samples >= 1 && samples <= 65535 && hits.size() == n);
  LUXEL_CHECK(!params.parts && !params.keep && !params.earlier && !params.layers);
  LUXEL_CHECK(!scene.in.tracer.has_tints());
  LandedRays out;
  out.element_count = n, out.samples = uint32_t(samples);
  const gather::SceneOfRays rays(scene.in, params);
  Round round{scene, uint32_t(samples), gather::seed_of_all_rays(params.seed)};
  LUXEL_TRY_STATUS(prepare(rays, round));
  const size_t tiles = (n + kTogether - 1) / kTogether;
  const size_t tiles_of_chunk =
      std::clamp<size_t>(land.rays_of_chunk / (kTogether * samples), 1, tiles);
  const uint64_t rays_of_chunk = tiles_of_chunk * kTogether * samples;
  LUXEL_TRY_STATUS(
      make_room_for_open(std::max<uint64_t>(rays_of_chunk / land.open_share, 1), round));
  std::vector<DeviceOpenRay> open;
  progress.begin("trace rays", n * samples);
  for (size_t first = 0; first < tiles; first += tiles_of_chunk) {
    LUXEL_TRY_STATUS(stopped(progress));
    LandedChunk chunk{first, std::min(tiles_of_chunk, tiles - first), {}};
    const uint64_t places = chunk.tile_count * kTogether * samples;
    LUXEL_TRY(chunk.hits, gpu::make_buffer(round.device(), places * sizeof(gather::StoredHit),
                                           gpu::Access::device, "the buffer of hits"));
    LUXEL_TRY(const double traced_s, land_chunk(chunk, round, open));
    LUXEL_TRY(const double light_s, light_of_escaped(chunk, round));
    seconds.device += traced_s + light_s;
    progress.advance(std::min(places, (n - first * kTogether) * samples));
    out.chunks.push_back(std::move(chunk));
  }
  out.left_open = open.size();
  constexpr size_t kMostOpen = size_t(1) << 31;
  if (open.size() >= kMostOpen)
    return fail(
        ErrorCode::unsupported,
        "{} rays on the device end where only the processor knows what they bring, of which "
        "it can take {}: bake with fewer samples or a smaller resolution, or without the "
        "device",
        open.size(), kMostOpen - 1);
  LUXEL_TRY_STATUS(take_counts(round, hits));
  const auto start = Clock::now();
  LUXEL_TRY(const std::vector<gather::HitTile> ended,
            gather::end_open_rays(scene.in, in_order(round, open), params, hits, progress));
  seconds.processor += seconds_since(start);
  LUXEL_TRY_STATUS(keep_more(round, ended, out));
  return out;
}

}  // namespace luxel::device
