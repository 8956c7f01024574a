// Every codec on the same factors of the Cornell box.
#include <algorithm>
#include <array>

#include "bench/relight.h"
#include "bench/timing.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/matrix/codec.h"
#include "luxel/solve/matrix/make_codec.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {
namespace {

constexpr size_t kPatches = 8192;
/// Patches of bc1, whose K of all bounces takes minutes to make at kPatches.
constexpr size_t kBc1Patches = 4096;
constexpr int kRelightCodecsRays = 8192, kRelightCodecsRounds = 9;
constexpr std::array<uint32_t, 4> kRanks{48, 96, 192, 384};
/// Products of F^c, plainly iterated: they err by less than any codec.
constexpr int kProducts = 24;

struct Room {
  scene::Scene scene;
  matrix::RelightParams params;
  matrix::Prepared prepared;
  matrix::CoarseScene coarse;
  matrix::Trials trials;

  matrix::CodecInput input() const { return {prepared, coarse, trials}; }
  const matrix::Patches& patches() const { return prepared.patched.patches; }
};

Result<Room> make_room(size_t patches, Progress& progress) {
  Room room;
  room.scene = scene::cornell_box();
  room.params.patches.count = patches, room.params.factors.rays_per_patch = kRelightCodecsRays;
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(room.scene));
  LUXEL_TRY(room.prepared, matrix::prepare(room.scene, tracer,
                                           {room.params.patches, room.params.factors}, progress));
  room.coarse = matrix::make_coarse_scene(
      room.prepared.factors, room.prepared.patched.tree, room.patches().area_m2,
      room.patches().elements.reflectance, matrix::kCoarseClusters);
  LUXEL_TRY(room.trials, matrix::make_trials(room.scene, tracer, room.prepared, room.coarse,
                                             {.anywhere = 0}, progress));
  return room;
}

struct Made {
  CodecRun run;
  matrix::Codec codec;
};

Made made_of(const Room& room, std::string name, std::string setting, matrix::Codec codec,
             double make_s) {
  Made made{{.codec = std::move(name), .setting = std::move(setting)}, std::move(codec)};
  CodecRun& run = made.run;
  run.patches = room.patches().size(), run.bytes = matrix::bytes_of(made.codec);
  run.error = matrix::usual_error(room.trials,
                                  matrix::errors_of(made.codec, room.trials, room.patches(), -1));
  run.make_s = make_s;
  return made;
}

Status make_by_error(const Room& room, std::vector<Made>& all, Progress& progress) {
  using Kind = matrix::CodecKind;
  const auto add = [&](std::string name, std::string setting, Kind kind,
                       float max_error) -> Status {
    matrix::RelightParams params = room.params;
    params.codec = kind, params.max_error = max_error;
    const auto start = Clock::now();
    LUXEL_TRY(matrix::MadeCodec codec, matrix::make_codec(room.input(), params, progress));
    const double make_s = seconds_since(start);
    all.push_back(
        made_of(room, std::move(name), std::move(setting), std::move(codec.codec), make_s));
    return {};
  };
  for (const float max_error : {0.03f, 0.02f, 0.01f, 0.005f})
    LUXEL_TRY_STATUS(add("hierarchical", fmt::format("--max-error {}", max_error),
                         Kind::hierarchical, max_error));
  LUXEL_TRY_STATUS(add("dense32", "", Kind::dense32, 0.01f));
  LUXEL_TRY_STATUS(add("dense16", "", Kind::dense16, 0.01f));
  return {};
}

Status make_by_rank(const Room& room, std::vector<Made>& all, Progress& progress) {
  const auto start = Clock::now();
  LUXEL_TRY(const matrix::Spectrum spectrum,
            matrix::spectrum_of(room.prepared.factors, room.patches().area_m2,
                                {.count = kRanks.back()}, progress));
  const double spectrum_s = seconds_since(start);
  for (const size_t rank : kRanks) {
    const auto begin = Clock::now();
    LUXEL_TRY(matrix::LowRank low,
              matrix::make_low_rank(spectrum, rank, room.patches().area_m2,
                                    room.patches().elements.reflectance, progress));
    const double make_s = spectrum_s + seconds_since(begin);
    all.push_back(made_of(room, "lowrank", fmt::format("rank {}", rank),
                          matrix::LowRankCodec{std::move(low)}, make_s));
  }
  return {};
}

/// For each codec, counts the products with F^c until the error is no more than the codec's.
void count_products(const Room& room, std::vector<Made>& all) {
  const std::vector<double> errors =
      matrix::errors_of_products(room.prepared, room.trials, kProducts);
  for (Made& made : all) {
    const auto enough = std::find_if(errors.begin(), errors.end(),
                                     [&](double error) { return error <= made.run.error; });
    made.run.products = int(std::min<ptrdiff_t>(enough - errors.begin() + 1, kProducts));
  }
}

/// Times all codecs and the yardstick, in turn.
void time_all(const Room& room, std::vector<Made>& all, CodecRuns& out) {
  const matrix::Patches& patches = room.patches();
  const std::span<const Rgb> rho = patches.elements.reflectance;
  const std::vector<Rgb>& sent = room.trials.sent[0];
  const matrix::ColourMatrix colour = make_colour_factors(room.prepared.factors, rho);
  matrix::DenseScratch dense_scratch = matrix::make_dense_scratch(patches.size());
  std::vector<Rgb> e(patches.size());
  std::vector<matrix::CodecScratch> scratch;
  for (const Made& made : all) scratch.push_back(matrix::make_scratch(made.codec, patches.size()));
  std::vector<std::function<void()>> tasks;
  for (size_t k = 0; k < all.size(); ++k)
    tasks.push_back([&, k] {
      irradiance_of(all[k].codec, {sent, rho, patches.area_m2, -1}, e, scratch[k]);
    });
  tasks.push_back([&] { multiply(colour, sent, e, dense_scratch); });
  const std::vector<double> ms = time_in_turn(tasks, kRelightCodecsRounds);
  for (size_t k = 0; k < all.size(); ++k) all[k].run.ms = ms[k];
  out.colour_ms = ms.back(), out.colour_bytes = matrix::bytes_of(colour);
}

/// In a smaller room; bytes and time as of `patches`, in proportion to the pairs there are.
Result<CodecRun> run_bc1(size_t patches, Progress& progress) {
  // The matrix of fewer patches, because preparing it takes so long.
  LUXEL_TRY(const Room room, make_room(kBc1Patches, progress));
  matrix::RelightParams params = room.params;
  params.codec = matrix::CodecKind::bc1;
  const auto start = Clock::now();
  LUXEL_TRY(matrix::MadeCodec codec, matrix::make_codec(room.input(), params, progress));
  const double make_s = seconds_since(start);
  const size_t n = room.patches().size();
  Made made = made_of(room, "bc1", fmt::format("of {} patches, scaled by the pairs", n),
                      std::move(codec.codec), make_s);
  matrix::CodecScratch scratch = matrix::make_scratch(made.codec, n);
  std::vector<Rgb> e(n);
  const std::vector<std::function<void()>> tasks{[&] {
    irradiance_of(
        made.codec,
        {room.trials.sent[0], room.patches().elements.reflectance, room.patches().area_m2, -1}, e,
        scratch);
  }};
  // Time and bytes grow with the pairs.
  const double pairs = double(patches) * double(patches) / (double(n) * double(n));
  made.run.ms = pairs * time_in_turn(tasks, kRelightCodecsRounds).front();
  made.run.bytes = uint64_t(pairs * double(made.run.bytes));
  std::vector<Made> all;
  all.push_back(std::move(made));
  count_products(room, all);
  return std::move(all.front().run);
}

}  // namespace

Result<CodecRuns> run_codecs(Progress& progress) {
  LUXEL_TRY(const Room room, make_room(kPatches, progress));
  std::vector<Made> all;
  LUXEL_TRY_STATUS(make_by_error(room, all, progress));
  LUXEL_TRY_STATUS(make_by_rank(room, all, progress));
  CodecRuns out;
  out.patches = room.patches().size(), out.rays = kRelightCodecsRays;
  count_products(room, all);
  progress.begin("timing", 0);
  time_all(room, all, out);
  for (Made& made : all) out.runs.push_back(std::move(made.run));
  LUXEL_TRY(CodecRun bc1, run_bc1(out.patches, progress));
  out.runs.push_back(std::move(bc1));
  return out;
}

}  // namespace luxel::bench
