#include "luxel/reference/path_tracer.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/share_out.h"
#include "luxel/reference/paths.h"
#include "luxel/reference/sums.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/transport/back_faces.h"

namespace luxel::reference {
namespace {

/// Paths that are followed together: many enough for full packets, few enough for a core's cache.
constexpr size_t kBatch = 2048;

/// Receivers or pixels that one task works on: some batches' worth, so that buffers are reused, yet
/// enough tasks for all threads. Depends on nothing but the size of the work.
size_t grain_for(size_t count, int samples) {
  const size_t full = std::clamp<size_t>(8 * kBatch / size_t(samples), 8, kBatch / 4);
  return std::clamp<size_t>(count / 64, 1, full);
}

/// Samples [first_sample, last_sample) of receivers or pixels [begin, end).
struct Batch {
  size_t begin, end, first_sample, last_sample;
};

/// Goes through `count` receivers or pixels in tasks, and through their paths in batches of about
/// kBatch: start(batch, paths) makes a batch's paths, sample by sample of each receiver; each(i,
/// path) sees every path of receiver i at its end; finish(i, sums, n) takes what its n paths have
/// summed to, which sets `found`: all members of a team get all of that. Returns the number of
/// rays.
template <class Start, class Each, class Finish, class... Found>
Result<uint64_t> run_tasks(const TracedScene& world, size_t count, const PathParams& params,
                           Team* team, Progress& progress, const Start& start, const Each& each,
                           const Finish& finish, std::span<Found>... found) {
  std::atomic<uint64_t> rays{0};
  const size_t samples = size_t(params.samples);
  const auto task = [&](size_t begin, size_t end) {
    PathBuffers work;
    std::vector<Path> paths;
    std::vector<Sums> sums(end - begin);
    const size_t per_batch = std::max<size_t>(1, kBatch / (end - begin));
    uint64_t traced = 0;
    for (size_t first = 0; first < samples && !progress.cancelled(); first += per_batch) {
      const size_t last = std::min(samples, first + per_batch);
      paths.clear();
      start(Batch{begin, end, first, last}, paths);
      traced += follow(world, params.bounces, paths, work);
      for (size_t k = 0; k < paths.size(); ++k) {
        const size_t i = k / (last - first);
        sums[i].add(paths[k].value);
        each(begin + i, paths[k]);
      }
      progress.advance(paths.size());
    }
    for (size_t i = begin; i < end; ++i) finish(i, sums[i - begin], double(samples));
    rays += traced;
  };
  LUXEL_TRY_STATUS(
      share_ranges(team, count, grain_for(count, params.samples), progress, task, found...));
  return sum_of_members(team, rays.load(), progress);
}

uint64_t path_seed(uint64_t seed, size_t item, size_t sample) {
  return hash64(hash64(seed, item), sample);
}

/// Where a sample of a receiver starts.
size_t point_of(const Receivers& receivers, size_t i, size_t sample) {
  if (receivers.first.empty()) return i;
  const size_t first = receivers.first[i];
  return first + sample % (receivers.first[i + 1] - first);
}

}  // namespace

Result<TexelPaths> irradiance_by_paths(const scene::Scene& scene, const Receivers& receivers,
                                       const trace::RayTracer& tracer, const PathParams& params,
                                       Progress& progress, Team* team) {
  const size_t count = receivers.size();
  LUXEL_CHECK(params.samples >= 1);
  LUXEL_CHECK(!params.is_one_place ||
              (receivers.first.empty() && count * size_t(params.samples) <= UINT32_MAX));
  LUXEL_CHECK(receivers.normal.size() == receivers.position.size());
  LUXEL_CHECK(receivers.geometric_normal.size() == receivers.position.size());
  const TracedScene world = traced_scene(scene, tracer);
  TexelPaths out;
  out.irradiance.resize(count), out.standard_error.resize(count), out.luminance_error.resize(count);
  out.met_back.resize(count), out.met_double_sided_back.resize(count), out.enclosed.resize(count);
  progress.begin("trace paths", uint64_t(count) * uint64_t(params.samples));
  const auto start = [&](const Batch& batch, std::vector<Path>& paths) {
    for (size_t i = batch.begin; i < batch.end; ++i)
      for (size_t s = batch.first_sample; s < batch.last_sample; ++s) {
        const size_t k = point_of(receivers, i, s);
        const Receiver at{receivers.position[k], receivers.normal[k],
                          receivers.geometric_normal[k]};
        paths.push_back(path_from(at, {path_seed(params.seed, i, s)}));
        if (params.is_one_place)
          paths.back().cells = {{uint32_t(s * count + i), uint32_t(count * size_t(params.samples))},
                                params.seed};
      }
  };
  const auto each = [&](size_t i, const Path& path) {
    out.met_back[i] += path.first_hit == FirstHit::back;
    out.met_double_sided_back[i] += path.first_hit == FirstHit::double_sided_back;
  };
  const auto finish = [&](size_t i, const Sums& sums, double n) {
    out.irradiance[i] = mean_of(sums, n) * kPi;
    out.standard_error[i] = error_of(sums, n) * kPi;
    out.luminance_error[i] = float(standard_error(sums.l, sums.l2, n)) * kPi;
    out.enclosed[i] = transport::is_enclosed(
        transport::BackFaces{int(n), int(out.met_back[i]), int(out.met_double_sided_back[i])});
  };
  LUXEL_TRY(out.rays, run_tasks(world, count, params, team, progress, start, each, finish,
                                std::span(out.irradiance), std::span(out.standard_error),
                                std::span(out.luminance_error), std::span(out.met_back),
                                std::span(out.met_double_sided_back), std::span(out.enclosed)));
  double sum = 0;
  for (const Rgb& e : out.irradiance) sum += double(luminance(e));
  out.relative_error = relative_error(out.luminance_error, sum);
  return out;
}

Result<Picture> radiance_by_paths(const scene::Scene& scene, const trace::RayTracer& tracer,
                                  const scene::Camera& camera, int width, int height,
                                  const PathParams& params, Progress& progress) {
  LUXEL_CHECK(params.samples >= 1 && width > 0 && height > 0);
  const TracedScene world = traced_scene(scene, tracer);
  const trace::CameraRays camera_rays(camera, width, height);
  const size_t count = size_t(width) * size_t(height);
  Picture out;
  out.radiance = image::Image(width, height, 4);
  out.luminance_error.resize(count);
  progress.begin("trace paths", uint64_t(count) * uint64_t(params.samples));
  std::vector<uint32_t> covered(count);
  const auto start = [&](const Batch& batch, std::vector<Path>& paths) {
    std::vector<trace::Ray> rays;
    std::vector<RandomStream> randoms;
    for (size_t i = batch.begin; i < batch.end; ++i)
      for (size_t s = batch.first_sample; s < batch.last_sample; ++s) {
        RandomStream random{path_seed(params.seed, i, s)};
        const Vec2 jitter = random.next2();
        rays.push_back(camera_rays.through(float(i % size_t(width)) + jitter.x,
                                           float(i / size_t(width)) + jitter.y));
        randoms.push_back(random);
      }
    const std::vector<trace::Hit> hits = trace::visible_hits(scene, tracer, rays);
    for (size_t k = 0; k < hits.size(); ++k)
      paths.push_back(path_from_eye(world, rays[k].direction, hits[k], randoms[k]));
  };
  const auto each = [&](size_t i, const Path& path) { covered[i] += path.shows_surface; };
  const auto finish = [&](size_t i, const Sums& sums, double n) {
    const int x = int(i % size_t(width)), y = int(i / size_t(width));
    out.radiance.set_rgb(x, y, mean_of(sums, n));
    out.radiance.at(x, y)[3] = float(double(covered[i]) / n);
    out.luminance_error[i] = float(standard_error(sums.l, sums.l2, n));
  };
  LUXEL_TRY(out.rays, run_tasks(world, count, params, nullptr, progress, start, each, finish));
  double sum = 0;
  for (size_t i = 0; i < count; ++i)
    sum += double(luminance(out.radiance.rgb(int(i % size_t(width)), int(i / size_t(width)))));
  out.relative_error = relative_error(out.luminance_error, sum);
  return out;
}

}  // namespace luxel::reference
