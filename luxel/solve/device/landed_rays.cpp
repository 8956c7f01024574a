#include "luxel/solve/device/landed_rays.h"

#include <algorithm>
#include <cstring>

#include "luxel/base/check.h"
#include "luxel/base/clock.h"
#include "luxel/gpu/pieces.h"
#include "luxel/solve/device/device_surroundings.h"
#include "luxel/solve/device/landings.h"
#include "luxel/solve/device/open_list.h"
#include "luxel/solve/device/shaders/escaped_light.comp.h"
#include "luxel/solve/device/shaders/landed_rays_binary.comp.h"
#include "luxel/solve/device/shaders/landed_rays_wide.comp.h"
#include "luxel/solve/gather/rays/ray_tile.h"
#include "luxel/solve/gather/trace/scene_of_rays.h"

namespace luxel::device {
namespace {

/// Rays that the processor ends have at most one hit each. Hits are numbered in 32 bits, half of
/// which leaves room for those of the buffer that goes beyond this.
constexpr uint64_t kMostOpen = (uint64_t(1) << 31) - 1;

// Structs of landed_rays.glsl and escaped_light.comp.

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
  uint64_t seed;          ///< of all elements
  size_t tiles_of_chunk;  ///< at most
  ElementBuffers from{};
  gpu::Buffer landings{}, mixed{};
  gpu::Buffer counts{};  ///< EndCounts of a chunk's elements
  OpenList open{};
  gpu::Pipeline land{};
  gpu::PieceSize land_piece{kTogether}, escaped_piece{kTogether};
  // Only where light comes from around.
  DeviceSurroundings around{};
  gpu::Buffer light{};  ///< gather::EscapedLight of a chunk's elements
  gpu::Pipeline escaped{};

  const gpu::Device& device() const { return scene.tracer.device(); }
  size_t element_count() const { return scene.in.elements.size(); }
  size_t elements_of_chunk() const { return tiles_of_chunk * kTogether; }
  bool is_dark_around() const { return light.size == 0; }
};

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

/// Whether light comes from around at all.
bool shines(const scene::Scene& scene, const light::Surroundings& around) {
  return !scene.environment.empty() || max_component(around.background) > 0;
}

Status prepare_surroundings(Round& round) {
  const scene::Scene& scene = round.scene.in.scene;
  const light::Surroundings& around = round.scene.in.lights.around;
  if (!shines(scene, around)) return {};
  LUXEL_TRY(round.around, upload_surroundings(round.scene.commands, scene.environment, around));
  LUXEL_TRY(round.light, gpu::make_buffer(round.device(),
                                          round.elements_of_chunk() * sizeof(gather::EscapedLight),
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
  LUXEL_TRY(round.landings, gpu::uploaded_or_one(commands, landings, "the buffer of the lightmap"));
  std::span<const uint64_t> mixed;
  if (in.sides) mixed = in.sides->mixed;
  LUXEL_TRY(round.mixed,
            gpu::uploaded_or_one(commands, mixed, "the buffer of walls in the lightmap"));
  LUXEL_TRY(round.counts,
            gpu::make_buffer(round.device(), round.elements_of_chunk() * sizeof(EndCounts),
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
                     .open = round.open.rays.address,
                     .seed_low = uint32_t(round.seed),
                     .seed_high = uint32_t(round.seed >> 32),
                     .element_count = uint32_t(round.element_count()),
                     .samples = round.samples,
                     .resolution = uint32_t(round.scene.in.atlas.resolution),
                     .has_mixed = has_mixed};
  return gpu::uploaded_or_one(round.scene.commands, std::span(&values, 1),
                              "the buffer of a round's settings");
}

/// Counts of a chunk's elements and the list of open rays begin anew.
Status reset(const Round& round) {
  return round.scene.commands.run([&](VkCommandBuffer c) {
    gpu::full_barrier(round.device(), c);
    round.device().vk.vkCmdFillBuffer(c, round.counts.buffer.get(), 0, VK_WHOLE_SIZE, 0);
    record_emptying(round.device(), c, round.open);
  });
}

/// Traces a chunk's rays once, and returns the seconds.
Result<double> trace_chunk(const LandedChunk& chunk, Round& round) {
  LUXEL_TRY_STATUS(reset(round));
  LUXEL_TRY(const gpu::Buffer setup, setup_of(round));
  const LandPush push{setup.address, chunk.hits.address, uint32_t(chunk.first_tile)};
  return gpu::run_groups(round.scene.commands, round.land, push, chunk.tile_count * gather::kCells,
                         round.land_piece);
}

/// Finds where a chunk's rays land, and which ones the device leaves open. `seconds` gets those of
/// the device.
Result<std::vector<DeviceOpenRay>> land_chunk(const LandedChunk& chunk, Round& round,
                                              double& seconds) {
  gpu::Commands& commands = round.scene.commands;
  LUXEL_TRY(const double took, trace_chunk(chunk, round));
  LUXEL_TRY(const uint32_t count, open_count(commands, round.open));
  seconds += took;
  if (count > round.open.capacity) {
    round.open = {};
    // The next chunks may leave a few more open.
    LUXEL_TRY(round.open, make_open_list(round.device(), count + count / 4));
    LUXEL_TRY(const double again, trace_chunk(chunk, round));
    LUXEL_TRY(const uint32_t now, open_count(commands, round.open));
    LUXEL_CHECK(now == count);
    seconds += again;
  }
  return read_open(commands, round.open, count);
}

/// Adds up what a chunk's escaped rays see. Returns the seconds.
Result<double> light_of_escaped(const LandedChunk& chunk, Round& round) {
  if (round.is_dark_around()) return 0.0;
  const LightPush push{.around = round.around.values.address,
                       .elements = round.from.elements.address,
                       .plain = round.from.samples.address,
                       .hits = chunk.hits.address,
                       .light = round.light.address,
                       .seed_low = uint32_t(round.seed),
                       .seed_high = uint32_t(round.seed >> 32),
                       .element_count = uint32_t(round.element_count()),
                       .samples = round.samples,
                       .first_tile = uint32_t(chunk.first_tile)};
  return gpu::run_groups(round.scene.commands, round.escaped, push, chunk.tile_count,
                         round.escaped_piece);
}

/// Notes what the rays of elements [begin, end) met, of those that the device has not left open,
/// and what they saw outside.
Status take_counts(const Round& round, size_t begin, size_t end, gather::TracedHits& hits) {
  const size_t n = end - begin;
  gpu::Commands& commands = round.scene.commands;
  LUXEL_TRY(const auto counts, downloaded<EndCounts>(commands, round.counts, n));
  std::vector<gather::EscapedLight> light;
  if (!round.is_dark_around()) {
    LUXEL_TRY(light, downloaded<gather::EscapedLight>(commands, round.light, n));
  }
  for (size_t k = 0; k < n; ++k) {
    const size_t i = begin + k;
    hits.samples[i] = hits.counted[i] = uint16_t(round.samples);
    hits.escaped[i] = uint16_t(counts[k].escaped);
    hits.met_back[i] = uint16_t(counts[k].dark_back);
    hits.met_double_sided_back[i] = uint16_t(counts[k].lit_back);
    if (light.empty()) continue;
    hits.sky[i] = light[k].sum, hits.sky_luminance2[i] = light[k].luminance2;
    hits.sky_first_less_second[i] = luminance(light[k].sum) - 2 * light[k].second_luminance;
  }
  hits.rays += n * round.samples;
  return {};
}

/// Hits of rays that the processor has ended, element after element.
struct MoreHits {
  std::vector<gather::StoredHit> hits;
  std::vector<uint32_t> ends;  ///< one past each element's last one

  void add(std::span<const gather::HitTile> tiles) {
    for (const gather::HitTile& tile : tiles) {
      for (const uint32_t end : tile.end) ends.push_back(uint32_t(hits.size()) + end);
      hits.insert(hits.end(), tile.entries.begin(), tile.entries.end());
    }
  }
};

/// Everything about the rays of a chunk. Errors: as land_rays().
Status finish_chunk(const gather::SceneOfRays& rays, LandedChunk& chunk, Round& round,
                    gather::TracedHits& hits, LandedRays& out, MoreHits& more,
                    LandedSeconds& seconds, Progress& progress) {
  const size_t begin = chunk.first_tile * kTogether;
  const size_t end = std::min(begin + chunk.tile_count * kTogether, round.element_count());
  const uint64_t places = chunk.tile_count * kTogether * round.samples;
  LUXEL_TRY(chunk.hits, gpu::make_buffer(round.device(), places * sizeof(gather::StoredHit),
                                         gpu::Access::device, "the buffer of hits"));
  LUXEL_TRY(const std::vector<DeviceOpenRay> open, land_chunk(chunk, round, seconds.device));
  LUXEL_TRY(const double light_s, light_of_escaped(chunk, round));
  seconds.device += light_s;
  LUXEL_TRY_STATUS(take_counts(round, begin, end, hits));
  const auto start = Clock::now();
  LUXEL_TRY(const std::vector<gather::HitTile> ended,
            gather::end_open_rays(rays, round.scene.in, begin, end,
                                  in_order(open, begin, end, round.scene.tracer), hits, progress));
  more.add(ended);
  seconds.processor += seconds_since(start);
  out.left_open += open.size();
  if (out.left_open <= kMostOpen) return {};
  return fail(ErrorCode::unsupported,
              "more than {} rays on the device end where only the processor knows what they bring: "
              "bake with fewer samples or a smaller resolution, or without the device",
              kMostOpen);
}

/// Sends the device the hits of rays that the processor has ended.
Status keep_more(const Round& round, const MoreHits& more, LandedRays& out) {
  LUXEL_CHECK(more.ends.size() == round.element_count() && more.hits.size() <= UINT32_MAX);
  gpu::Commands& commands = round.scene.commands;
  constexpr std::string_view kWhat = "the buffer of hits";
  LUXEL_TRY(out.ends, gpu::uploaded_or_one(commands, more.ends, kWhat));
  LUXEL_TRY(out.more, gpu::uploaded_or_one(commands, more.hits, kWhat));
  return {};
}

/// Tiles of a chunk of hits: whole ones of gather's own.
size_t tiles_of_chunk(const LandParams& land, size_t tiles) {
  constexpr size_t kOfGather = gather::kTileElements / kTogether;
  static_assert(kOfGather * kTogether == gather::kTileElements);
  const size_t wanted = land.rays_of_chunk / (kTogether * uint64_t(land.samples));
  return std::min(std::max(wanted / kOfGather, size_t(1)) * kOfGather, tiles);
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
  const size_t tiles = (n + kTogether - 1) / kTogether;
  Round round{scene, uint32_t(samples), gather::seed_of_all_rays(params.seed),
              tiles_of_chunk(land, tiles)};
  LUXEL_TRY_STATUS(prepare(rays, round));
  const uint64_t rays_of_chunk = round.elements_of_chunk() * samples;
  LUXEL_TRY(round.open,
            make_open_list(round.device(), std::max<uint64_t>(rays_of_chunk / land.open_share, 1)));
  MoreHits more;
  progress.begin("trace rays", n * samples);
  for (size_t first = 0; first < tiles; first += round.tiles_of_chunk) {
    LUXEL_TRY_STATUS(stopped(progress));
    LandedChunk chunk{first, std::min(round.tiles_of_chunk, tiles - first), {}};
    LUXEL_TRY_STATUS(finish_chunk(rays, chunk, round, hits, out, more, seconds, progress));
    const size_t end = std::min((first + chunk.tile_count) * kTogether, n);
    progress.advance((end - first * kTogether) * samples);
    out.chunks.push_back(std::move(chunk));
  }
  LUXEL_TRY_STATUS(keep_more(round, more, out));
  return out;
}

}  // namespace luxel::device
