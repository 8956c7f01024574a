#include "luxel/solve/hemicube/look.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <mutex>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/viewfactor/hemicube.h"

namespace luxel::hemicube {
namespace {

/// Rays between two looks at the clock and at Progress.
constexpr size_t kBatch = 16384;

struct Pixel {
  Vec3 direction;
  float factor = 0;
};

/// All pixels, in tiles of 4 x 4 of a face: a packet of rays that stay together.
Result<std::vector<Pixel>> pixels_in_tiles(int resolution, Progress& progress) {
  LUXEL_TRY(const viewfactor::Hemicube cube, viewfactor::make_hemicube(resolution, progress));
  std::vector<Pixel> pixels;
  pixels.reserve(cube.direction.size());
  size_t first = 0;
  for (int face = 0; face < 5; ++face) {
    const int rows = face == 0 ? resolution : resolution / 2;
    for (int y = 0; y < rows; y += 4)
      for (int x = 0; x < resolution; x += 4)
        for (int j = y; j < std::min(y + 4, rows); ++j)
          for (int i = x; i < std::min(x + 4, resolution); ++i) {
            const size_t k = first + size_t(j) * size_t(resolution) + size_t(i);
            pixels.push_back({cube.direction[k], float(cube.delta_factor[k])});
          }
    first += size_t(rows) * size_t(resolution);
  }
  return pixels;
}

/// The hemicube stands askew about the normal, by an angle without a simple tangent: rows of pixels
/// that run along the edges of a room would see all of an edge or nothing of it.
Frame frame_of_cube(Vec3 normal) {
  constexpr float kCosine = 0.90630779f, kSine = 0.42261826f;  // 25 degrees
  const Frame f = frame_around(normal);
  return {f.tangent * kCosine + f.bitangent * kSine, f.bitangent * kCosine - f.tangent * kSine,
          normal};
}

/// Sums shares per element; remembers which elements have one.
class Shares {
 public:
  explicit Shares(size_t count) : share_(count), touched_((count + 63) / 64) {}

  void add(uint32_t element, float share) {
    share_[element] += share;
    touched_[element / 64] |= uint64_t(1) << (element % 64);
  }
  /// Moves the sums out, in the order of the elements, and starts anew.
  void take(std::vector<uint32_t>& element, std::vector<float>& share) {
    element.clear(), share.clear();
    for (size_t w = 0; w < touched_.size(); ++w) {
      for (uint64_t bits = touched_[w]; bits != 0; bits &= bits - 1) {
        const uint32_t i = uint32_t(64 * w) + uint32_t(std::countr_zero(bits));
        element.push_back(i), share.push_back(share_[i]);
        share_[i] = 0;
      }
      touched_[w] = 0;
    }
  }

 private:
  std::vector<float> share_;
  std::vector<uint64_t> touched_;
};

/// What a hit on a surface means, known per triangle of the scene.
struct Sort {
  bool two_sided = false, emissive = false;
};

/// Buffers of one worker.
struct Work {
  std::vector<trace::Ray> rays;
  std::vector<float> factor;
  std::vector<trace::Hit> hits;
  Shares shares;
  View view;
  LookSeconds seconds;

  explicit Work(size_t senders) : shares(senders) {}
};

class Looker {
 public:
  Looker(const Senders& senders, std::vector<Pixel> pixels)
      : s_(senders),
        pixels_(std::move(pixels)),
        diagonal_m_(scene::world_bounds(senders.scene).diagonal()) {
    for (const scene::Material& m : s_.scene.materials)
      sorts_.push_back(
          {scene::reflects_from_behind(m), max_component(m.emission) > 0 && s_.emission_by_pixels});
  }

  size_t pixel_count() const { return pixels_.size(); }

  /// Fills work.view. False when cancelled.
  bool look_from(const Viewpoint& from, Work& work, Progress& progress) const {
    work.view.emitted = {};
    work.view.back = work.view.two_sided_back = 0;
    const Frame frame = frame_of_cube(from.normal);
    const Vec3 origin = trace::offset_origin(from.position, from.geometric_normal, diagonal_m_);
    for (size_t first = 0; first < pixels_.size(); first += kBatch) {
      if (progress.cancelled()) return false;
      const auto start = Clock::now();
      aim(std::span(pixels_).subspan(first, std::min(kBatch, pixels_.size() - first)), frame,
          origin, from.geometric_normal, work);
      const auto aimed = Clock::now();
      s_.tracer.closest_hits(work.rays, work.hits, trace::Packets::bundles);
      const auto traced = Clock::now();
      for (size_t k = 0; k < work.hits.size(); ++k)
        count(work.hits[k], work.rays[k].direction, work.factor[k], work);
      work.seconds.visibility += seconds(traced - aimed);
      work.seconds.summation += seconds(Clock::now() - traced) + seconds(aimed - start);
    }
    const auto start = Clock::now();
    work.shares.take(work.view.element, work.view.share);
    work.seconds.summation += seconds(Clock::now() - start);
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

  /// Rays through pixels. Those below the element's own triangle see its back: black.
  static void aim(std::span<const Pixel> pixels, const Frame& frame, Vec3 origin,
                  Vec3 geometric_normal, Work& work) {
    work.rays.clear(), work.factor.clear();
    for (const Pixel& pixel : pixels) {
      const Vec3 d = frame.to_world(pixel.direction);
      if (dot(d, geometric_normal) <= 0) continue;
      work.rays.push_back({origin, 0, d, INFINITY});
      work.factor.push_back(pixel.factor);
    }
    work.hits.resize(work.rays.size());
  }

  void count(const trace::Hit& hit, Vec3 direction, float factor, Work& work) const {
    if (!hit.found()) {
      work.view.emitted += light::soft_radiance(s_.scene, s_.around, direction) * (kPi * factor);
      return;
    }
    const scene::Instance& instance = s_.scene.instances[hit.instance];
    const Sort sort = sorts_[s_.scene.meshes[instance.mesh].triangle_material[hit.triangle]];
    if (hit.back_face && !sort.two_sided) {
      work.view.back += factor;
      return;
    }
    if (hit.back_face) work.view.two_sided_back += factor;
    if (sort.emissive)
      work.view.emitted += scene::emission_at(s_.scene, hit.point()) * (kPi * factor);
    const Place place = locate(s_.mesh, hit.point());
    if (s_.receivers.kind == ElementKind::triangle) {
      work.shares.add(s_.receivers.leaf_of_node[place.node], factor);
      return;
    }
    const auto& vertex = s_.mesh.nodes[place.node].vertex;
    work.shares.add(vertex[0], factor * (1 - place.at.u - place.at.v));
    work.shares.add(vertex[1], factor * place.at.u);
    work.shares.add(vertex[2], factor * place.at.v);
  }

  const Senders& s_;
  std::vector<Pixel> pixels_;
  std::vector<Sort> sorts_;
  float diagonal_m_;
};

}  // namespace

Result<LookSeconds> look(const Senders& senders, std::span<const Viewpoint> from,
                         const LookParams& params,
                         const std::function<Status(size_t, const View&)>& done,
                         Progress& progress) {
  LUXEL_CHECK(params.resolution >= 2 && params.resolution % 2 == 0);
  // One set of pixels serves all viewpoints.
  LUXEL_TRY(std::vector<Pixel> pixels, pixels_in_tiles(params.resolution, progress));
  const Looker looker(senders, std::move(pixels));
  progress.begin("hemicubes", from.size());
  std::mutex mutex;
  Status status;
  LookSeconds sum;
  parallel_for(from.size(), kTileElements, [&](size_t begin, size_t end) {
    // One thread looks from neighbours, in order. The first failure stops all.
    Work work(senders.receivers.size());
    for (size_t i = begin; i < end; ++i) {
      if (!looker.look_from(from[i], work, progress)) return;
      const Status kept = done(i, work.view);
      if (!kept) {
        const std::lock_guard lock(mutex);
        if (status) status = kept;
        progress.request_cancel();
        return;
      }
      progress.advance(1);
    }
    const std::lock_guard lock(mutex);
    sum.visibility += work.seconds.visibility, sum.summation += work.seconds.summation;
  });
  if (!status) return tl::unexpected(status.error());
  LUXEL_TRY_STATUS(stopped(progress));
  return sum;
}

std::vector<Viewpoint> viewpoints(const transport::Elements& elements) {
  std::vector<Viewpoint> out;
  out.reserve(elements.size());
  for (size_t i = 0; i < elements.size(); ++i)
    out.push_back({elements.position[i], elements.normal[i], elements.geometric_normal[i]});
  return out;
}

}  // namespace luxel::hemicube
