#include "luxel/solve/hemicube/look.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <mutex>

#include "luxel/base/check.h"
#include "luxel/base/share_out.h"
#include "luxel/solve/hemicube/item_buffer.h"
#include "luxel/solve/hemicube/look_device.h"
#include "luxel/viewfactor/hemicube.h"

namespace luxel::hemicube {
namespace {

/// Rays between two looks at the clock and at Progress.
constexpr size_t kBatch = 16384;

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

/// Properties of a surface that decide what a hit on it means, known per triangle of the scene.
struct SurfaceKind {
  bool two_sided = false, emissive = false;
};

/// Buffers of one worker.
struct Buffers {
  std::vector<trace::Ray> rays;
  std::vector<float> factor;
  std::vector<trace::Hit> hits;
  Shares shares;
  View view;
  LookSeconds seconds;

  explicit Buffers(size_t senders) : shares(senders) {}
};

class Looker {
 public:
  Looker(const Senders& senders, std::vector<Pixel> pixels)
      : s_(senders), pixels_(std::move(pixels)) {
    for (const scene::Material& m : s_.scene.materials)
      kinds_.push_back(
          {scene::reflects_from_behind(m), max_component(m.emission) > 0 && s_.emission_by_pixels});
  }

  size_t pixel_count() const { return pixels_.size(); }

  /// Fills buffers.view. False when cancelled.
  bool look_from(const Viewpoint& from, Buffers& buffers, Progress& progress) const {
    buffers.view.emitted = {};
    buffers.view.back = buffers.view.two_sided_back = 0;
    const Frame frame = frame_of_cube(from.normal);
    for (size_t first = 0; first < pixels_.size(); first += kBatch) {
      if (progress.cancelled()) return false;
      const auto start = Clock::now();
      aim(std::span(pixels_).subspan(first, std::min(kBatch, pixels_.size() - first)), frame,
          from.position, from.geometric_normal, buffers);
      const auto aimed = Clock::now();
      s_.tracer.closest_hits(buffers.rays, buffers.hits, trace::Packets::bundles);
      const auto traced = Clock::now();
      for (size_t k = 0; k < buffers.hits.size(); ++k)
        count(buffers.hits[k], buffers.rays[k].direction, buffers.factor[k], buffers);
      buffers.seconds.visibility += seconds(traced - aimed);
      buffers.seconds.summation += seconds(Clock::now() - traced) + seconds(aimed - start);
    }
    const auto start = Clock::now();
    buffers.shares.take(buffers.view.element, buffers.view.share);
    buffers.seconds.summation += seconds(Clock::now() - start);
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

  /// Rays through pixels. Those below the element's own triangle see its back: black.
  static void aim(std::span<const Pixel> pixels, const Frame& frame, Vec3 origin,
                  Vec3 geometric_normal, Buffers& buffers) {
    buffers.rays.clear(), buffers.factor.clear();
    for (const Pixel& pixel : pixels) {
      const Vec3 d = frame.to_world(pixel.direction);
      if (dot(d, geometric_normal) <= 0) continue;
      buffers.rays.push_back({origin, 0, d, INFINITY});
      buffers.factor.push_back(pixel.factor);
    }
    buffers.hits.resize(buffers.rays.size());
  }

  void count(const trace::Hit& hit, Vec3 direction, float factor, Buffers& buffers) const {
    if (!hit.found()) {
      buffers.view.emitted += light::soft_radiance(s_.scene, s_.around, direction) * (kPi * factor);
      return;
    }
    const scene::Instance& instance = s_.scene.instances[hit.instance];
    const SurfaceKind kind = kinds_[s_.scene.meshes[instance.mesh].triangle_material[hit.triangle]];
    if (hit.back_face && !kind.two_sided) {
      buffers.view.back += factor;
      return;
    }
    if (hit.back_face) buffers.view.two_sided_back += factor;
    if (kind.emissive)
      buffers.view.emitted += scene::emission_at(s_.scene, hit.point()) * (kPi * factor);
    const MeshPoint point = locate(s_.mesh, hit.point());
    if (s_.receivers.kind == ElementKind::triangle) {
      buffers.shares.add(s_.receivers.leaf_of_node[point.node], factor);
      return;
    }
    const auto& vertex = s_.mesh.nodes[point.node].vertex;
    buffers.shares.add(vertex[0], factor * (1 - point.at.u - point.at.v));
    buffers.shares.add(vertex[1], factor * point.at.u);
    buffers.shares.add(vertex[2], factor * point.at.v);
  }

  const Senders& s_;
  std::vector<Pixel> pixels_;
  std::vector<SurfaceKind> kinds_;
};

}  // namespace

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

Result<LookSeconds> look(const Senders& senders, std::span<const Viewpoint> from,
                         const LookParams& params, const OnView& done, Progress& progress) {
  LUXEL_CHECK(params.resolution >= 2 && params.resolution % 2 == 0);
  if (params.device) return params.device->look(senders, from, params, done, progress);
  // One set of pixels serves all viewpoints.
  LUXEL_TRY(std::vector<Pixel> pixels, pixels_in_tiles(params.resolution, progress));
  const Looker looker(senders, std::move(pixels));
  progress.begin("hemicubes", from.size());
  std::mutex mutex;
  Status status;
  LookSeconds sum;
  const auto look_from_group = [&](size_t group) {
    const size_t begin = group * kTileElements;
    const size_t end = std::min(begin + kTileElements, from.size());
    // One thread looks from neighbours, in order. The first failure stops all.
    Buffers buffers(senders.receivers.size());
    for (size_t i = begin; i < end; ++i) {
      if (!looker.look_from(from[i], buffers, progress)) return;
      const Status kept = done(i, buffers.view);
      if (!kept) {
        const std::lock_guard lock(mutex);
        if (status) status = kept;
        progress.request_cancel();
        return;
      }
      progress.advance(1);
    }
    const std::lock_guard lock(mutex);
    sum.visibility += buffers.seconds.visibility, sum.summation += buffers.seconds.summation;
  };
  const size_t groups = (from.size() + kTileElements - 1) / kTileElements;
  const auto own = share_out(params.team, groups, progress, look_from_group);
  LUXEL_TRY_STATUS(status);
  if (!own) return Failure{own.error()};
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
