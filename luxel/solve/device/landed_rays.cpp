#include "luxel/solve/device/landed_rays.h"

#include <algorithm>
#include <optional>

#include "luxel/base/check.h"
#include "luxel/base/clock.h"
#include "luxel/solve/device/device_elements.h"
#include "luxel/solve/device/escaped_shared.h"
#include "luxel/solve/device/kept_chunk.h"
#include "luxel/solve/device/landings.h"
#include "luxel/solve/device/open_list.h"
#include "luxel/solve/device/ray_slots.h"
#include "luxel/solve/device/shaders/escaped_light.comp.h"
#include "luxel/solve/device/shaders/landed_rays.comp.h"
#include "luxel/solve/gather/rays/ray_tile.h"
#include "luxel/solve/gather/trace/follow_many.h"
#include "luxel/solve/gather/trace/kept_hits.h"
#include "luxel/solve/gather/trace/scene_of_rays.h"

namespace luxel::device {
namespace {

/// Rays that the processor ends have at most one hit each. Hits are numbered in 32 bits, half of
/// which leaves room for those of the buffer that goes beyond this.
constexpr uint64_t kMostOpen = (uint64_t(1) << 31) - 1;

using on_device::EndCounts, on_device::EscapedPush, on_device::LandPush, on_device::RaySeeds;

RaySeeds ray_seeds(uint64_t seed) {
  const uint64_t guided = gather::seed_of_guided_rays(seed);
  return {on_device::halves(gather::seed_of_all_rays(seed)),
          on_device::halves(gather::seed_of_all_rays(guided))};
}

static_assert(sizeof(gather::EscapedLight) == 20);  // as shaders/escaped_light.comp writes it

/// A round on its way.
struct Round {
  const DeviceScene& scene;
  const gather::SceneOfRays& on_processor;
  KeptStage kept;
  RaySeeds seeds;
  LandedRays& rays;
  gather::TracedHits& hits;
  gpu::Buffer shares{};
  // Room for the chunk that has the most slots:
  gpu::Buffer counts{};  ///< EndCounts of each
  gpu::Buffer light{};   ///< gather::EscapedLight of each, where light comes from around
  OpenList open{};
  // Hits of rays that the processor has ended, element after element, and one past each element's
  // last one.
  std::vector<gather::StoredHit> more{};
  std::vector<uint32_t> more_ends{};

  gpu::Commands& commands() const { return scene.commands; }
  const gpu::Device& device() const { return scene.tracer.device(); }
};

/// Light comes from the surroundings.
bool shines(const scene::Scene& scene, const light::Surroundings& around) {
  return !scene.environment.empty() || max_component(around.background) > 0;
}

/// Room for what a round finds of its largest chunk.
Status make_room(const RoundSlots& slots, const LandParams& land, Round& round) {
  uint64_t most_slots = 0, most_places = 0;
  for (const SlotChunk& chunk : slots.chunks) {
    most_slots = std::max<uint64_t>(most_slots, chunk.slots.size());
    most_places = std::max<uint64_t>(most_places, chunk.first_row.back() * uint64_t(kTogether));
  }
  LUXEL_TRY(round.counts, gpu::make_buffer(round.device(), most_slots * sizeof(EndCounts),
                                           gpu::Access::device, "the buffer of counts"));
  if (!round.rays.is_dark_around) {
    LUXEL_TRY(round.light,
              gpu::make_buffer(round.device(), most_slots * sizeof(gather::EscapedLight),
                               gpu::Access::device, "the buffer of the sky's light"));
  }
  LUXEL_TRY(round.open,
            make_open_list(round.device(), std::max<uint64_t>(most_places / land.open_share, 1)));
  LUXEL_TRY(round.shares,
            gpu::uploaded_or_one(round.commands(), slots.shares, "the buffer of rays' shares"));
  return {};
}

/// The buffer of what shaders are told of a chunk.
Result<gpu::Buffer> setup_of(const LandedChunk& chunk, const Round& round) {
  const transport::OwnSides* sides = round.scene.in.sides;
  const on_device::LandSetup values{.world = round.scene.tracer.world(),
                                    .elements = round.rays.elements.address,
                                    .landings = round.rays.landings.address,
                                    .mixed = round.rays.mixed.address,
                                    .shares = round.shares.address,
                                    .slots = chunk.slots.address,
                                    .rows = chunk.first_row.address,
                                    .counts = round.counts.address,
                                    .open = round.open.rays.address,
                                    .seeds = round.seeds,
                                    .slot_count = uint32_t(chunk.slot_count),
                                    .resolution = uint32_t(round.scene.in.atlas.resolution),
                                    .has_mixed = sides && !sides->mixed.empty()};
  return gpu::uploaded(round.commands(), std::as_bytes(std::span(&values, 1)),
                       "the buffer of a round's settings");
}

/// Hits and counts of a chunk, and the list of open rays, begin anew. What is 0 landed nowhere.
Status reset(const LandedChunk& chunk, const Round& round) {
  const auto& vk = round.device().vk;
  return round.commands().run([&](VkCommandBuffer c) {
    gpu::full_barrier(round.device(), c);
    vk.vkCmdFillBuffer(c, chunk.hits.buffer.get(), 0, VK_WHOLE_SIZE, 0);
    vk.vkCmdFillBuffer(c, round.counts.buffer.get(), 0, VK_WHOLE_SIZE, 0);
    record_emptying(round.device(), c, round.open);
  });
}

/// Traces a chunk's rays once, and returns the seconds.
Result<double> trace_chunk(const LandedChunk& chunk, Round& round) {
  LUXEL_TRY_STATUS(reset(chunk, round));
  LUXEL_TRY(const gpu::Buffer setup, setup_of(chunk, round));
  return gpu::run_groups(round.commands(), round.rays.land,
                         LandPush{setup.address, chunk.hits.address, 0},
                         chunk.tile_count * gather::kCells, round.rays.land_piece);
}

/// Finds where a chunk's rays land, and which ones the device leaves open. `seconds` gets those of
/// the device.
Result<std::vector<on_device::OpenRay>> land_chunk(const LandedChunk& chunk, Round& round,
                                                   double& seconds) {
  gpu::Commands& commands = round.commands();
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
  if (round.rays.is_dark_around) return 0.0;
  const EscapedPush push{.around = round.rays.around.values.address,
                         .elements = round.rays.elements.address,
                         .shares = round.shares.address,
                         .slots = chunk.slots.address,
                         .rows = chunk.first_row.address,
                         .hits = chunk.hits.address,
                         .light = round.light.address,
                         .seeds = round.seeds,
                         .slot_count = uint32_t(chunk.slot_count),
                         .first_group = 0};
  return gpu::run_groups(round.commands(), round.rays.escaped, push, chunk.tile_count,
                         round.rays.escaped_piece);
}

/// Adds what the rays of an element met and saw outside, of those that the device has not left
/// open. What was there before is of the first half now.
void take_element(const on_device::RaySlot& slot, const EndCounts& counts,
                  const gather::EscapedLight& light, Round& round) {
  gather::TracedHits& hits = round.hits;
  const size_t i = slot.element;
  hits.samples[i] = uint16_t(slot.end), hits.last_round[i] = uint8_t(round.rays.rounds.size());
  hits.sky_first_less_second[i] = luminance(hits.sky[i]);
  hits.sky[i] += light.sum, hits.sky_luminance2[i] += light.luminance2;
  hits.sky_first_less_second[i] += luminance(light.sum) - 2 * light.second_luminance;
  hits.rays += counts.rays;
  if (gather::is_guided(hits, i)) return;  // they do not tell where the element lies
  const auto add = [](uint32_t count, uint16_t& to) { to = uint16_t(to + count); };
  hits.counted[i] = hits.samples[i];
  add(counts.escaped, hits.escaped[i]), add(counts.dark_back, hits.met_back[i]);
  add(counts.lit_back, hits.met_double_sided_back[i]);
}

/// take_element() of a chunk's slots. Returns how many rays each has.
Result<std::vector<uint32_t>> take_counts(std::span<const on_device::RaySlot> slots, Round& round) {
  constexpr std::string_view kBack = "the buffer of what comes back";
  LUXEL_TRY(const auto counts,
            gpu::downloaded<EndCounts>(round.commands(), round.counts, slots.size(), kBack));
  std::vector<gather::EscapedLight> light(slots.size());
  if (!round.rays.is_dark_around) {
    LUXEL_TRY(light, gpu::downloaded<gather::EscapedLight>(round.commands(), round.light,
                                                           slots.size(), kBack));
  }
  std::vector<uint32_t> rays;
  for (size_t k = 0; k < slots.size(); ++k) {
    take_element(slots[k], counts[k], light[k], round);
    rays.push_back(counts[k].rays);
  }
  return rays;
}

/// Ends the rays of a chunk's elements that the device has left open. Returns their hits.
Result<std::vector<gather::HitTile>> end_open(const SlotChunk& slots,
                                              std::span<const on_device::OpenRay> open,
                                              Round& round, Progress& progress) {
  // Elements before the chunk without any rays have no more hits.
  round.more_ends.resize(slots.begin, uint32_t(round.more.size()));
  trace::DeviceRayTracer& tracer = round.scene.tracer;
  std::optional<gather::PathDevice> device;
  if (round.scene.light)
    device.emplace(gather::PathDevice{
        *round.scene.light, [&](std::span<const trace::Ray> rays, std::span<trace::Hit> hits) {
          return tracer.closest_hits(rays, hits);
        }});
  LUXEL_TRY(std::vector<gather::HitTile> ended,
            gather::end_open_rays(round.on_processor, round.scene.in, slots.begin, slots.end,
                                  in_order(open, slots.begin, slots.end, tracer),
                                  device ? &*device : nullptr, round.hits, progress));
  for (const gather::HitTile& tile : ended) {
    for (const uint32_t end : tile.end)
      round.more_ends.push_back(uint32_t(round.more.size()) + end);
    round.more.insert(round.more.end(), tile.entries.begin(), tile.entries.end());
  }
  round.rays.left_open += open.size();
  if (round.more.size() <= kMostOpen) return ended;
  return fail(ErrorCode::unsupported,
              "more than {} rays of a round end where only the processor can compute their light: "
              "bake with fewer samples or a lower resolution, or without the device",
              kMostOpen);
}

/// Everything about the rays of a chunk. Errors: as land_round().
Result<LandedChunk> finish_chunk(const SlotChunk& slots, Round& round, LandedSeconds& seconds,
                                 Progress& progress) {
  gpu::Commands& commands = round.commands();
  LandedChunk out{slots.slots.size(), slots.first_row.size() - 1, {}, {}, {}};
  LUXEL_TRY(out.slots, gpu::uploaded_or_one(commands, slots.slots, "the buffer of slots of rays"));
  LUXEL_TRY(out.first_row, gpu::uploaded_or_one(commands, slots.first_row, "the buffer of rows"));
  const uint64_t places = slots.first_row.back() * uint64_t(kTogether);
  LUXEL_TRY(out.hits, gpu::make_buffer(round.device(), places * sizeof(gather::StoredHit),
                                       gpu::Access::device, "the buffer of hits"));
  LUXEL_TRY(const std::vector<on_device::OpenRay> open, land_chunk(out, round, seconds.device));
  LUXEL_TRY(const double light_s, light_of_escaped(out, round));
  seconds.device += light_s;
  LUXEL_TRY(const std::vector<uint32_t> rays, take_counts(slots.slots, round));
  const auto start = Clock::now();
  const uint64_t before = round.hits.rays;
  LUXEL_TRY(const std::vector<gather::HitTile> ended, end_open(slots, open, round, progress));
  seconds.processor += seconds_since(start);
  LUXEL_TRY_STATUS(keep_chunk({slots, rays, round.hits.rays - before, ended}, out.hits,
                              {round.kept, commands, round.hits}));
  return out;
}

/// Sends the device what the processor has found of a round.
Status keep_round(Round& round, LandedRound& out) {
  constexpr std::string_view kWhat = "the buffer of hits";
  round.more_ends.resize(round.rays.element_count, uint32_t(round.more.size()));
  LUXEL_TRY(out.ends, gpu::uploaded_or_one(round.commands(), round.more_ends, kWhat));
  LUXEL_TRY(out.more, gpu::uploaded_or_one(round.commands(), round.more, kWhat));
  std::vector<uint32_t> counted;
  for (size_t i = 0; i < round.rays.element_count; ++i)
    counted.push_back(uint32_t(round.hits.first_round[i]) | uint32_t(round.hits.last_round[i])
                                                                << 8);
  LUXEL_TRY(round.rays.counted_rounds,
            gpu::uploaded_or_one(round.commands(), counted, "the buffer of counted rounds"));
  return {};
}

/// A work group with more rays in each slot takes so much longer. With fewer it takes less, but for
/// what each thread does once: pieces grow by as much as run_in_pieces() lets them.
void fit_pieces(const RoundSlots& slots, LandedRays& rays) {
  uint32_t most = 1;
  for (const SlotChunk& chunk : slots.chunks) most = std::max(most, chunk.slots.front().places);
  if (rays.places_of_piece > 0)
    for (gpu::PieceSize* piece : {&rays.land_piece, &rays.escaped_piece})
      piece->items =
          std::clamp<size_t>(piece->items * rays.places_of_piece / most, 1, 4 * piece->items);
  rays.places_of_piece = most;
}

}  // namespace

Result<LandedRays> begin_rays(const DeviceScene& scene, const gather::TraceParams& params) {
  const gather::TraceScene& in = scene.in;
  gpu::Commands& commands = scene.commands;
  LUXEL_CHECK(in.elements.size() > 0 && !in.tracer.has_tints());
  const gather::SceneOfRays rays(in, params);
  LandedRays out;
  out.element_count = in.elements.size();
  LUXEL_TRY(out.elements, upload_elements(commands, in.elements));
  LUXEL_TRY(out.landings,
            gpu::uploaded_or_one(commands, landings_of(rays.rays()), "the buffer of the lightmap"));
  std::span<const uint64_t> mixed;
  if (in.sides) mixed = in.sides->mixed;
  LUXEL_TRY(out.mixed,
            gpu::uploaded_or_one(commands, mixed, "the buffer of walls in the lightmap"));
  LUXEL_TRY(out.land,
            gpu::make_compute_pipeline(commands.device(), landed_rays_comp(scene.tracer.kind()),
                                       {sizeof(LandPush), {}}, {scene.tracer.shader_constant()}));
  const light::Surroundings& around = in.lights.around;
  out.is_dark_around = !shines(in.scene, around);
  if (out.is_dark_around) return out;
  LUXEL_TRY(out.around, upload_surroundings(commands, in.scene.environment, around));
  LUXEL_TRY(out.escaped, gpu::make_compute_pipeline(commands.device(), escaped_light_comp,
                                                    {sizeof(EscapedPush), {}}));
  return out;
}

Status land_round(const DeviceScene& scene, std::span<const uint16_t> target,
                  const LandParams& land, const gather::TraceParams& params, LandedRays& rays,
                  gather::TracedHits& hits, LandedSeconds& seconds, Progress& progress) {
  const size_t n = rays.element_count;
  LUXEL_CHECK(scene.in.elements.size() == n && target.size() == n && hits.size() == n);
  LUXEL_CHECK(hits.rounds.size() == rays.rounds.size() && rays.rounds.size() < 256);
  LUXEL_CHECK(!params.keep && !params.earlier && !params.layers);
  const gather::SceneOfRays on_processor(scene.in, params);
  Round round{scene, on_processor, gather::kept_round(hits, target, params), ray_seeds(params.seed),
              rays,  hits};
  const RoundSlots slots = slots_of_round(target, hits, land.rays_of_chunk);
  progress.begin("trace rays", slots.samples);
  LandedRound out;
  if (!slots.chunks.empty()) {
    fit_pieces(slots, rays);
    LUXEL_TRY_STATUS(make_room(slots, land, round));
  }
  for (const SlotChunk& chunk : slots.chunks) {
    LUXEL_TRY_STATUS(stopped(progress));
    LUXEL_TRY(LandedChunk landed, finish_chunk(chunk, round, seconds, progress));
    out.chunks.push_back(std::move(landed));
    uint64_t samples = 0;
    for (const on_device::RaySlot& slot : chunk.slots) samples += slot.end - slot.first;
    progress.advance(samples);
  }
  LUXEL_TRY_STATUS(keep_round(round, out));
  rays.rounds.push_back(std::move(out));
  return {};
}

}  // namespace luxel::device
