// luxel bench rays, maps, threads: how fast gather is.
#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <chrono>

#include "bench/bench.h"
#include "bench/scenes_of_rays.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/gather/gather.h"
#include "luxel/solve/gather/rays/element_rays.h"
#include "luxel/solve/gather/trace/trace_hits.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::bench {
namespace {

/// The triangles of a scene, in the world, in one Embree scene of this file's own: the yardstick.
class BareEmbree {
 public:
  explicit BareEmbree(const scene::Scene& scene)
      : device_(rtcNewDevice(nullptr)), top_(rtcNewScene(device_)) {
    for (const scene::Instance& instance : scene.instances)
      add(scene.meshes[instance.mesh], instance.world_from_object);
    rtcSetSceneFlags(top_, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(top_, RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(top_);
  }
  BareEmbree(const BareEmbree&) = delete;
  BareEmbree& operator=(const BareEmbree&) = delete;
  ~BareEmbree() {
    rtcReleaseScene(top_);
    rtcReleaseDevice(device_);
  }

  /// The number of rays that meet something.
  uint64_t intersect(std::span<const trace::Ray> rays) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    uint64_t found = 0;
    for (const trace::Ray& ray : rays) {
      RTCRayHit rh;
      rh.ray = {ray.origin.x,
                ray.origin.y,
                ray.origin.z,
                ray.t_min,
                ray.direction.x,
                ray.direction.y,
                ray.direction.z,
                0,
                ray.t_max,
                ~0u,
                0,
                0};
      rh.hit.geomID = rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(top_, &context, &rh);
      found += rh.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return found;
  }

 private:
  void add(const scene::Mesh& mesh, const Mat34& map) {
    RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<Vec3*>(rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), mesh.positions.size()));
    auto* indices = static_cast<std::array<uint32_t, 3>*>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                sizeof(mesh.triangles[0]), mesh.triangles.size()));
    std::transform(mesh.positions.begin(), mesh.positions.end(), vertices,
                   [&](Vec3 p) { return transform_point(map, p); });
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
    rtcCommitGeometry(g);
    rtcAttachGeometry(top_, g);
    rtcReleaseGeometry(g);
  }

  RTCDevice device_;
  RTCScene top_;
};

/// Rays per second of the bare loop over gather's own rays; making the rays is not counted.
double bare_rate(const validate::Prepared& p, int samples) {
  const BareEmbree embree(p.scene);
  std::atomic<uint64_t> nanoseconds{0};
  parallel_for(p.elements.size(), 1024, [&](size_t begin, size_t end) {
    std::vector<trace::Ray> rays(size_t(samples) * (end - begin));
    for (size_t i = begin; i < end; ++i)
      gather::element_rays(p.elements.position[i], p.elements.normal[i],
                           p.elements.geometric_normal[i], hash64(1 ^ 0x6a7e, i),
                           std::span(rays).subspan((i - begin) * size_t(samples), size_t(samples)));
    const auto start = Clock::now();
    embree.intersect(rays);
    nanoseconds += uint64_t(seconds_since(start) * 1e9);
  });
  return double(p.elements.size()) * samples / (double(nanoseconds) * 1e-9 / thread_count());
}

light::TexelScene scene_of(const validate::Prepared& p) {
  return {p.scene, p.atlas, p.map, p.elements, p.lights, *p.tracer};
}

double gather_rate(const validate::Prepared& p, int samples) {
  Progress progress;
  const auto start = Clock::now();
  const auto hits = gather::trace_hits({p.scene, p.atlas, p.elements, p.lights, *p.tracer}, samples,
                                       {}, progress);
  return hits ? double(hits->rays) / seconds_since(start) : 0.0;
}

}  // namespace

Result<Table> measure_rays(const std::filesystem::path& shared, int threads) {
  const ThreadLimit limit(threads);
  constexpr int kSamples = 64, kRounds = 5;
  Table table{"rays",
              thread_count(),
              {"scene", "rtcIntersect1 loop, Mrays/s", "gather, Mrays/s", "ratio (median of 5)"},
              {},
              {},
              nlohmann::json::array()};
  for (const NamedScene& named : scenes_of_rays(shared)) {
    if (!is_here(named, table)) continue;
    LUXEL_TRY(scene::Scene scene, load(named));
    Progress layout;
    LUXEL_TRY(const auto p, validate::prepare(std::move(scene), 512, layout));
    // In turn, so that a machine that speeds up or slows down does it to both.
    std::vector<double> bare, ours, ratio;
    for (int round = 0; round < kRounds; ++round) {
      bare.push_back(bare_rate(*p, kSamples));
      ours.push_back(gather_rate(*p, kSamples));
      ratio.push_back(ours.back() / bare.back());
    }
    for (auto* values : {&bare, &ours, &ratio}) std::sort(values->begin(), values->end());
    const size_t middle = kRounds / 2;
    table.rows.push_back({named.name, fmt::format("{:.2f}", bare[middle] * 1e-6),
                          fmt::format("{:.2f}", ours[middle] * 1e-6),
                          fmt::format("{:.2f}", ratio[middle])});
    table.json.push_back({{"scene", named.name},
                          {"bare_mrays_per_s", bare[middle] * 1e-6},
                          {"gather_mrays_per_s", ours[middle] * 1e-6},
                          {"ratio", ratio[middle]}});
  }
  return table;
}

Result<Table> measure_maps(const std::filesystem::path&, int threads) {
  const ThreadLimit limit(threads);
  // [Moreno05, table 5.1]: solution time on a GeForce 6800, 200 direct and 800 indirect samples.
  constexpr std::array<std::pair<int, double>, 4> kPaper{
      {{64, 8.276}, {128, 15.865}, {256, 37.971}, {512, 144.815}}};
  Table table{"maps",
              thread_count(),
              {"atlas", "paper, s", "luxel, s", "paper / luxel", "Mrays/s"},
              {},
              {},
              nlohmann::json::array()};
  for (const auto& [resolution, paper_s] : kPaper) {
    Progress progress;
    LUXEL_TRY(const auto p, validate::prepare(scene::cornell_box(), resolution, progress));
    gather::GatherParams params;
    params.direct_samples = 200;
    params.samples = 800;
    const auto start = Clock::now();
    LUXEL_TRY(const gather::Gather result,
              gather::gather(scene_of(*p), nullptr, params, {}, {}, progress));
    const double seconds = seconds_since(start);
    table.rows.push_back({fmt::format("{0} x {0}", resolution), fmt::format("{:.3f}", paper_s),
                          fmt::format("{:.3f}", seconds), fmt::format("{:.1f}", paper_s / seconds),
                          fmt::format("{:.1f}", double(result.rays) * 1e-6 / seconds)});
    table.json.push_back({{"resolution", resolution}, {"paper_s", paper_s}, {"luxel_s", seconds}});
  }
  table.notes.push_back(
      "The paper's column is a GeForce 6800 with a 2.53 GHz Pentium 4 (2005), one running average "
      "over all bounces; ours is the processor named above, all bounces converged to 1e-4.");
  return table;
}

Result<Table> measure_threads(const std::filesystem::path& shared, int) {
  Table table{"threads", 2,  {"scene", "1 thread, s", "2 threads, s", "speed-up (median of 5)"},
              {},        {}, nlohmann::json::array()};
  std::vector<NamedScene> scenes{{"Cornell box", {}},
                                 {"suzanne_room", shared / "scenes/suzanne_room/room.glb"}};
  for (const NamedScene& named : scenes) {
    if (!is_here(named, table)) continue;
    LUXEL_TRY(scene::Scene scene, load(named));
    Progress layout;
    LUXEL_TRY(const auto p, validate::prepare(std::move(scene), 512, layout));
    // Seconds of a bake with so many threads.
    const auto run = [&](int threads) {
      const ThreadLimit limit(threads);
      gather::GatherParams params;
      params.samples = 64;
      Progress progress;
      const auto start = Clock::now();
      const auto result = gather::gather(scene_of(*p), nullptr, params, {}, {}, progress);
      return result ? seconds_since(start) : 0.0;
    };
    // Both in turn, so that what else the machine does falls on both.
    std::vector<double> one, two, ratio;
    for (int round = 0; round < 5; ++round) {
      one.push_back(run(1)), two.push_back(run(2));
      ratio.push_back(one.back() / two.back());
    }
    for (auto* values : {&one, &two, &ratio}) std::sort(values->begin(), values->end());
    table.rows.push_back({named.name, fmt::format("{:.2f}", one[2]), fmt::format("{:.2f}", two[2]),
                          fmt::format("{:.2f}", ratio[2])});
    table.json.push_back({{"scene", named.name}, {"speed_up", ratio[2]}});
  }
  return table;
}

}  // namespace luxel::bench
