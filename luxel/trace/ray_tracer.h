// Finds the surfaces that rays hit. Batches in, hits out.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/base/vec.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/shared_meshes.h"

namespace luxel::trace {

/// A ray from origin + t_min direction to origin + t_max direction.
struct Ray {
  Vec3 origin;
  float t_min = 0;
  Vec3 direction;  ///< need not be of unit length; t is in units of its length
  float t_max = INFINITY;
};

/// The closest solid surface along a ray. `instance` is kNone when there is none.
struct Hit {
  float t = INFINITY;
  uint32_t instance = scene::kNone;
  uint32_t triangle = 0;
  Barycentric at;
  bool back_face = false;  ///< the ray came from behind the front side

  /// The ray meets a surface.
  bool found() const { return instance != scene::kNone; }
  /// Where it meets it; only when found().
  scene::SurfacePoint point() const { return {instance, triangle, at}; }
};

/// A box that may be turned: all that is no farther from its middle than `half_m` along three axes.
struct TurnedBox {
  Vec3 middle;
  std::array<Vec3, 3> axes{};  ///< of unit length, at right angles
  Vec3 half_m;                 ///< along each axis
};

/// Coherence that the tracer may expect of 8 or 16 rays in a row of a batch, as many as the
/// processor's vectors have numbers.
enum class Packets : uint8_t {
  any,
  /// All from one place over a hemisphere, in order of direction. In scenes of few triangles many
  /// of them are traced like bundles, up to 2.5 times as fast (`luxel bench bundles`). Where
  /// surfaces coincide, which of them a ray meets may then depend on the rest of its packet.
  alike,
  bundles  ///< near to each other all the way, like neighbouring pixels: twice as fast
};

/// Two levels: a mesh with several instances is stored once, with its instances on top, in scenes
/// of more than a million drawn triangles; smaller scenes and single instances lie in the top
/// level, where rays meet one tight hierarchy. Both sides of every triangle block. Holes of alpha
/// masks do not; blended and transmissive surfaces (scene::Passage) let rays through by chance, the
/// share 1 - coverage of them: which ones follows from the bits of the ray and of the place it
/// meets, so that many rays see the right mean and the same ray always the same. Queries are const
/// and may run on many threads at once. `scene` is kept by reference and must outlive the tracer.
class RayTracer {
 public:
  /// `max_flat_triangles`: drawn triangles above which meshes are shared between instances.
  static Result<RayTracer> build(const scene::Scene& scene,
                                 size_t max_flat_triangles = kMaxFlatTriangles);
  /// Every mesh is stored once, however many instances it has, also in small scenes: rays take
  /// longer, but moved() does not.
  static Result<RayTracer> build_apart(const scene::Scene& scene);
  /// The tracer of a scene with the same meshes, whose instances may be others and stand elsewhere,
  /// and whose materials may have other colours: those that let light through are the same. Meshes
  /// that are stored once are shared between the two, and only the top level is built. Either may
  /// go first.
  Result<RayTracer> moved(const scene::Scene& scene) const;
  RayTracer(RayTracer&&) noexcept;
  RayTracer& operator=(RayTracer&&) noexcept;
  ~RayTracer();

  /// hits[i] is what rays[i] meets first. Rays are traced in packets of neighbours: rays with
  /// nearby origins and directions next to each other run faster. Sizes are equal.
  void closest_hits(std::span<const Ray> rays, std::span<Hit> hits,
                    Packets packets = Packets::any) const;
  /// As above, but without chance: what covers anything of what lies behind it, as far as that is
  /// so (scene::Passage), stops every ray.
  void closest_covers(std::span<const Ray> rays, std::span<Hit> hits,
                      Packets packets = Packets::any) const;
  /// The first hit of one ray. Many rays are faster in closest_hits().
  Hit closest_hit(const Ray& ray) const;
  /// blocked[i] is 1 when anything solid lies on rays[i] within (t_min, t_max).
  void occluded(std::span<const Ray> rays, std::span<uint8_t> blocked) const;

  /// No triangle reaches into the box, apart from those for which counts(instance, triangle) is
  /// false. True is certain. False may be said of a box that a triangle only comes near to, and is
  /// said of every box of a scene with meshes that are stored once. Takes a microsecond: worth it
  /// where many rays would lie within the box.
  bool is_empty(const TurnedBox& box, const std::function<bool(uint32_t, uint32_t)>& counts) const;

  /// True: some surface colours the light that it lets through.
  bool has_tints() const;
  /// Multiplies by the tints of what each ray that closest_hits has traced has passed on its way to
  /// its hit, or to its end: call it where has_tints().
  void tint(std::span<const Ray> rays, std::span<const Hit> hits, std::span<Rgb> light) const;
  /// The share of light that arrives from t_max, per channel: 0 where something opaque stands,
  /// the product of (1 - coverage) tint of all that lets light through. No chance is involved.
  /// Where nothing has a tint it is 1 unless occluded.
  void transmitted(std::span<const Ray> rays, std::span<Rgb> share) const;

  /// Triangles that were sorted into hierarchies to build it: drawn ones, and of meshes that are
  /// stored once, each once.
  size_t sorted_triangles() const;

 private:
  void closest_hits(std::span<const Ray> rays, std::span<Hit> hits, Packets packets,
                    bool by_chance) const;
  static Result<RayTracer> build_with(const scene::Scene& scene, const std::vector<bool>& shared);
  struct Impl;
  explicit RayTracer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace luxel::trace
