// The paper's measurements, repeated.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "bench/relight_paper.h"
#include "bench/timing.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/matrix/bc1_picture.h"
#include "luxel/solve/matrix/bounces.h"
#include "luxel/solve/matrix/dense.h"
#include "luxel/solve/matrix/matrix.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {
namespace {

constexpr int kBounces = 5;
constexpr int kRelightPaperRunsRounds = 15;

/// In the air of the Cornell box, near walls, near the blocks' tops, in corners.
const std::vector<Vec3> kLights{
    {0.278f, 0.45f, 0.28f}, {0.10f, 0.40f, 0.10f}, {0.45f, 0.30f, 0.15f}, {0.278f, 0.25f, 0.10f},
    {0.10f, 0.50f, 0.45f},  {0.50f, 0.50f, 0.50f}, {0.05f, 0.10f, 0.40f}, {0.52f, 0.10f, 0.10f},
    {0.18f, 0.40f, 0.40f},  {0.36f, 0.45f, 0.35f}};

/// The box without its lamp, its patches and K.
struct PaperRoom {
  scene::Scene scene;
  matrix::MatrixParams params;
  matrix::Prepared prepared;
  matrix::ColourMatrix k;
  std::vector<std::vector<Rgb>> sent;  ///< per light

  const matrix::FormFactors& factors() const { return prepared.factors; }
  std::span<const Rgb> reflectance() const { return prepared.patched.patches.elements.reflectance; }
  std::span<const float> area_m2() const { return prepared.patched.patches.area_m2; }
};

/// Finds the direct light that patches reflect, for each lamp.
Status light_up(PaperRoom& room, const trace::RayTracer& tracer, Progress& progress) {
  for (const Vec3 position : kLights) {
    scene::PunctualLight lamp;
    lamp.position = position;
    room.scene.lights = {lamp};
    LUXEL_TRY(const matrix::Solution lit,
              matrix::solve(room.scene, light::collect_lights(room.scene), tracer, room.prepared,
                            room.params, progress));
    std::vector<Rgb> sent = lit.direct;
    for (size_t i = 0; i < sent.size(); ++i) sent[i] = sent[i] * room.reflectance()[i];
    room.sent.push_back(std::move(sent));
  }
  return {};
}

Result<PaperRoom> make_room(size_t patches, PaperRuns& runs, Progress& progress) {
  PaperRoom room;
  room.scene = scene::cornell_box();
  for (scene::Material& material : room.scene.materials) material.emission = {};
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(room.scene));
  room.params.patches.count = patches;
  room.params.bounces = 0;
  LUXEL_TRY(room.prepared, matrix::prepare(room.scene, tracer, room.params, progress));
  LUXEL_TRY_STATUS(light_up(room, tracer, progress));
  const auto start = Clock::now();
  LUXEL_TRY(room.k, matrix::make_reflections(room.factors(), room.reflectance(), room.area_m2(),
                                             kBounces, progress));
  runs.reflections_s = seconds_since(start);
  runs.patches = room.k.n;
  return room;
}

void count(Histogram& histogram, double value, double weight = 1) {
  const double cell = std::floor((value - histogram.first) / histogram.step);
  const double last = double(histogram.share.size()) - 1;
  histogram.share[size_t(std::clamp(cell, 0.0, last))] += weight;
}

void normalise(Histogram& histogram) {
  const double all = std::accumulate(histogram.share.begin(), histogram.share.end(), 0.0);
  for (double& share : histogram.share) share /= all;
}

/// Figure 1.
void distribute_factors(const matrix::FormFactors& factors, PaperRuns& runs) {
  runs.factors = {-7, 0.25, std::vector<double>(28)};
  runs.small_factors = {0, 0.00025, std::vector<double>(20)};
  const double n = double(factors.size());
  double above = 0;
  for (const float f : factors.factor) {
    count(runs.factors, std::log10(double(f)));
    if (f < 0.005f) count(runs.small_factors, double(f));
    above += f >= 0.005f;
  }
  // Patches that do not see each other.
  count(runs.small_factors, 0, n * n - double(factors.factor.size()));
  runs.below = 1 - above / (n * n);
  normalise(runs.factors), normalise(runs.small_factors);
}

/// Figures 3 and 4.
void distribute_rest(const matrix::ColourMatrix& k, const Progress& progress, PaperRuns& runs) {
  matrix::Bc1Params params = matrix::paper_params();
  const matrix::Picture picture =
      matrix::picture_of(k, matrix::choose_kept(k, params.kept, progress), params, progress);
  runs.logarithms = {-30, 0.5, std::vector<double>(60)};
  runs.bytes = {0, 4, std::vector<double>(64)};
  for (size_t i = 0; i < k.n; ++i)
    for (size_t j = 0; j < k.n; ++j)
      for (size_t c = 0; c < 3 && !picture.is_kept(i, j); ++c) {
        const double part = double(k.channel[c][i * k.n + j]) / double(picture.largest[c]);
        count(runs.logarithms, part > 0 ? std::log(part) : -30);
        count(runs.bytes, picture.at(i, j)[c]);
      }
  normalise(runs.logarithms), normalise(runs.bytes);
}

EntryError error_of(const matrix::ColourMatrix& k, const matrix::Bc1& bc1) {
  const size_t n = k.n;
  std::vector<EntryError> of_row(n);
  parallel_for(n, 16, [&](size_t begin, size_t end) {
    std::vector<Rgb> row(n);
    for (size_t place = begin; place < end; ++place) {
      matrix::decode_row(bc1, place, row);
      EntryError& e = of_row[place];
      for (size_t c = 0; c < 3; ++c)
        for (size_t j = 0; j < n; ++j) {
          const double want = double(k.channel[c][bc1.row[place] * n + j]);
          const double error = std::abs(double(row[j][int(c)]) - want);
          e.total += error, e.largest = std::max(e.largest, error), e.relative += want;
        }
    }
  });
  EntryError out;
  for (const EntryError& e : of_row) {
    out.total += e.total, out.largest = std::max(out.largest, e.largest);
    out.relative += e.relative;
  }
  out.mean = out.total / double(3 * n * n), out.relative = out.total / out.relative;
  return out;
}

Result<EntryError> error_by(const matrix::ColourMatrix& k, const matrix::Bc1Params& params,
                            Progress& progress) {
  LUXEL_TRY(const matrix::Bc1 bc1, matrix::make_bc1(k, params, progress));
  return error_of(k, bc1);
}

/// The matrix with its patches in no order.
matrix::ColourMatrix shuffled(const matrix::ColourMatrix& k) {
  std::vector<uint32_t> order(k.n);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [](uint32_t a, uint32_t b) { return hash64(1, a) < hash64(1, b); });
  matrix::ColourMatrix out = k;
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < k.n; ++i)
      for (size_t j = 0; j < k.n; ++j)
        out.channel[c][i * k.n + j] = k.channel[c][size_t(order[i]) * k.n + order[j]];
  return out;
}

/// Figures 2 and 7.
Status measure_errors(const matrix::ColourMatrix& k, PaperRuns& runs, Progress& progress) {
  using Order = matrix::Bc1Params::Order;
  for (const float share : {0.005f, 0.01f, 0.02f, 0.03f, 0.04f, 0.06f, 0.08f}) {
    matrix::Bc1Params paper = matrix::paper_params(), ours;
    paper.kept = ours.kept = share;
    runs.kept.push_back(share);
    LUXEL_TRY(const EntryError of_paper, error_by(k, paper, progress));
    LUXEL_TRY(const EntryError of_ours, error_by(k, ours, progress));
    runs.of_kept.push_back(of_paper), runs.of_kept_default.push_back(of_ours);
  }
  const matrix::ColourMatrix mixed = shuffled(k);
  for (const Order order : {Order::as_is, Order::rows, Order::rows_and_columns}) {
    matrix::Bc1Params params = matrix::paper_params();
    params.order = order;
    LUXEL_TRY(runs.of_order[size_t(order)], error_by(k, params, progress));
    LUXEL_TRY(runs.of_order_shuffled[size_t(order)], error_by(mixed, params, progress));
  }
  return {};
}

/// Figures 11 and 12.
void measure_speed(const PaperRoom& room, const matrix::Bc1& bc1, PaperRuns& runs) {
  const matrix::Dense single = make_dense(room.factors(), matrix::Precision::single);
  const matrix::Dense half = make_dense(room.factors(), matrix::Precision::half);
  const matrix::ColourMatrix colour = make_colour_factors(room.factors(), room.reflectance());
  matrix::DenseScratch scratch = matrix::make_dense_scratch(runs.patches);
  matrix::Bc1Scratch bc1_scratch = matrix::make_bc1_scratch(bc1);
  matrix::BounceScratch bounces = matrix::make_bounce_scratch(runs.patches, 0);
  std::vector<Rgb> e(runs.patches), incident = room.sent[0];
  const auto counted = [&](const matrix::Dense& dense, int products) {
    const auto product = [&](std::span<const Rgb> b, std::span<Rgb> out) {
      multiply(dense, b, out, scratch);
    };
    count_bounces(std::ref(product), {room.sent[0], room.reflectance(), {}, products}, e, bounces);
  };
  // F in floats with 1 to kBounces products; F in halves and F^c with kBounces; K; K in bc1.
  std::vector<std::function<void()>> tasks;
  for (int products = 1; products <= kBounces; ++products)
    tasks.push_back([&, products] { counted(single, products); });
  tasks.push_back([&] { counted(half, kBounces); });
  tasks.push_back([&] {
    for (int product = 0; product < kBounces; ++product)
      multiply(colour, incident, e, scratch), std::swap(incident, e);
  });
  tasks.push_back([&] { multiply(room.k, room.sent[0], e, scratch); });
  tasks.push_back([&] { multiply(bc1, room.sent[0], e, bc1_scratch); });
  const std::vector<double> ms = time_in_turn(tasks, kRelightPaperRunsRounds);
  std::copy_n(ms.begin(), kBounces, runs.ms.single.begin());
  runs.ms.half = ms[5], runs.ms.colour = ms[6], runs.ms.reflections = ms[7], runs.ms.bc1 = ms[8];
  runs.single_bytes = bytes_of(single), runs.half_bytes = bytes_of(half);
  runs.colour_bytes = bytes_of(colour), runs.bc1_bytes = bytes_of(bc1);
}

/// Relative root mean square error of E per light, weighted by area, against K in floats.
std::vector<double> relit_errors(const PaperRoom& room, const matrix::Bc1& bc1) {
  matrix::DenseScratch scratch = matrix::make_dense_scratch(bc1.n);
  matrix::Bc1Scratch bc1_scratch = matrix::make_bc1_scratch(bc1);
  std::vector<Rgb> want(bc1.n), got(bc1.n);
  std::vector<double> out;
  for (const std::vector<Rgb>& sent : room.sent) {
    multiply(room.k, sent, want, scratch);
    multiply(bc1, sent, got, bc1_scratch);
    double error = 0, size = 0;
    for (size_t i = 0; i < want.size(); ++i) {
      const Rgb d = got[i] - want[i];
      error += double(room.area_m2()[i] * dot(d, d));
      size += double(room.area_m2()[i] * dot(want[i], want[i]));
    }
    out.push_back(std::sqrt(error / size));
  }
  return out;
}

}  // namespace

Result<PaperRuns> run_paper(size_t patches, Progress& progress) {
  PaperRuns runs;
  LUXEL_TRY(const PaperRoom room, make_room(patches, runs, progress));
  distribute_factors(room.factors(), runs);
  distribute_rest(room.k, progress, runs);
  LUXEL_TRY(const matrix::Bc1 paper, matrix::make_bc1(room.k, matrix::paper_params(), progress));
  const auto start = Clock::now();
  LUXEL_TRY(const matrix::Bc1 ours, matrix::make_bc1(room.k, {}, progress));
  runs.bc1_s = seconds_since(start);
  runs.light = kLights;
  runs.paper_error = relit_errors(room, paper), runs.default_error = relit_errors(room, ours);
  measure_speed(room, ours, runs);
  LUXEL_TRY_STATUS(measure_errors(room.k, runs, progress));
  return runs;
}

}  // namespace luxel::bench
