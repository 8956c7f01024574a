#include "luxel/transport/elements.h"

#include "luxel/base/free_memory.h"
#include "luxel/base/parallel.h"
#include "luxel/base/share_out.h"
#include "luxel/scene/facet.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/sides.h"

namespace luxel::transport {
namespace {

bool varies_over_texels(const scene::Material& material) {
  return material.base_color_texture.texture != scene::kNone ||
         material.metallic_texture.texture != scene::kNone ||
         material.diffuse_transmission_texture.texture != scene::kNone ||
         material.diffuse_transmission_color_texture.texture != scene::kNone;
}

using ColorAt = Rgb (*)(const scene::Scene&, const scene::SurfacePoint&);

/// Mean of a colour over a 4 x 4 grid of the texel, where the triangle covers it.
Rgb mean_over_texel(const scene::Scene& scene, const atlas::Atlas& atlas, const atlas::Texel& texel,
                    ColorAt color_at) {
  constexpr int kGrid = 4;
  const auto& corners = atlas.corners[texel.triangle_number];
  Rgb sum = color_at(scene, texel.sample);
  float count = 1;
  for (int j = 0; j < kGrid; ++j)
    for (int i = 0; i < kGrid; ++i) {
      const Vec2 p{float(texel.x) + (float(i) + 0.5f) / kGrid,
                   float(texel.y) + (float(j) + 0.5f) / kGrid};
      const Barycentric at = atlas::barycentric_in(corners, p);
      if (at.u < 0 || at.v < 0 || at.u + at.v > 1) continue;
      sum += color_at(scene, {texel.sample.instance, texel.sample.triangle, at});
      count += 1;
    }
  return sum / count;
}

/// Highest rise of a bulge, relative to the triangle's size: more than the sagitta of a sphere of
/// eight segments, and little enough not to come out behind a neighbouring wall.
constexpr float kMaxBulge = 0.25f;

/// A triangle and the surface that its vertex normals bend over it.
struct BentFacet {
  scene::Facet flat;
  bool bends = false;
  std::array<Vec3, 3> normals;  ///< of the vertices, unit, where it bends
  float size_m = 0;             ///< the root of its area
};

BentFacet bent_facet(const scene::Scene& scene, uint32_t instance, uint32_t triangle) {
  const scene::Instance& placed = scene.instances[instance];
  const scene::Mesh& mesh = scene.meshes[placed.mesh];
  BentFacet out;
  out.flat = scene::facet_of(scene, instance, triangle);
  out.size_m = std::sqrt(scene::area_m2(out.flat.corners));
  out.bends = !mesh.normals.empty();
  for (size_t k = 0; k < 3 && out.bends; ++k) {
    const Vec3 object = mesh.normals[mesh.triangles[triangle][k]];
    out.normals[k] = normalize(transform_normal(placed.world_from_object, object));
    // Beyond 60 degrees from the triangle a normal is not that of a smooth surface.
    out.bends = dot(out.normals[k], out.flat.front) >= 0.5f;
  }
  return out;
}

/// The point lifted to that surface: the mean, by barycentric weights, of its projections on the
/// three tangent planes above it. [Hanika21]
Vec3 lifted(const BentFacet& facet, Vec3 at, Barycentric place) {
  const scene::Triangle3& t = facet.flat.corners;
  const std::array<Vec3, 3> corners{t.a, t.b, t.c};
  const std::array<float, 3> weights{1 - place.u - place.v, place.u, place.v};
  Vec3 lift{};
  for (size_t k = 0; k < 3; ++k) {
    const Vec3 n = facet.normals[k];
    lift += n * (weights[k] * std::max(0.0f, dot(corners[k] - at, n)));
  }
  const float limit = kMaxBulge * facet.size_m;
  const float height = length(lift);
  return height <= limit ? at + lift : at + lift * (limit / height);
}

bool in_same_triangle(const scene::SurfacePoint& a, const scene::SurfacePoint& b) {
  return a.instance == b.instance && a.triangle == b.triangle;
}

/// Lower than this part of the triangle's size a bulge is rounding.
constexpr float kNoBulge = 1e-4f;

}  // namespace

void drop_places(Elements& elements) {
  free_memory(elements.position), free_memory(elements.normal);
  free_memory(elements.geometric_normal);
}

Elements subset(const Elements& elements, std::span<const uint32_t> chosen) {
  const auto pick = [&](const MappedVector<Vec3>& all) {
    MappedVector<Vec3> out;
    if (all.empty()) return out;
    out.reserve(chosen.size());
    for (const uint32_t i : chosen) out.push_back(all[i]);
    return out;
  };
  return {pick(elements.position), pick(elements.normal), pick(elements.geometric_normal),
          pick(elements.reflectance), pick(elements.transmittance)};
}

namespace {

SmoothPoint smooth_point(const scene::Scene& scene, const BentFacet& facet,
                         const scene::SurfacePoint& p, float side) {
  const scene::Triangle3& t = facet.flat.corners;
  const Vec3 at = interpolate(t.a, t.b, t.c, p.at);
  SmoothPoint out{at, {}, scene::shading_normal(scene, p, facet.flat.front), facet.flat.front};
  if (facet.bends) {
    out.position = lifted(facet, at, p.at);
    if (length(out.position - at) > kNoBulge * facet.size_m) out.geometric_normal = out.normal;
  }
  out.normal *= side, out.geometric_normal *= side;
  out.start = scene::off_surface(out.position, out.geometric_normal, facet.flat.size_m);
  return out;
}

}  // namespace

SmoothPoint smooth_point(const scene::Scene& scene, const scene::SurfacePoint& p, float side) {
  return smooth_point(scene, bent_facet(scene, p.instance, p.triangle), p, side);
}

namespace {

/// As many as the map has texels, where its memory is. No colours yet.
Elements places_of(const scene::Scene& scene, const atlas::TexelMap& map) {
  const size_t n = map.texels.size();
  const MappedAllocator<Vec3> where(map.texels.get_allocator());
  Elements e{MappedVector<Vec3>(where), MappedVector<Vec3>(where), MappedVector<Vec3>(where),
             MappedVector<Rgb>(where), MappedVector<Rgb>(where)};
  e.position.resize(n), e.normal.resize(n), e.geometric_normal.resize(n), e.reflectance.resize(n);
  if (scene::scatters_light(scene)) e.transmittance.resize(n);
  parallel_for(n, 4096, [&](size_t begin, size_t end) {
    BentFacet facet;
    for (size_t i = begin; i < end; ++i) {
      const scene::SurfacePoint& p = map.texels[i].sample;
      // Neighbours in a row mostly lie in one triangle.
      if (i == begin || !in_same_triangle(p, map.texels[i - 1].sample))
        facet = bent_facet(scene, p.instance, p.triangle);
      const SmoothPoint at = smooth_point(scene, facet, p, 1);
      e.position[i] = at.start, e.normal[i] = at.normal;
      e.geometric_normal[i] = at.geometric_normal;
    }
  });
  return e;
}

/// The colours of elements [begin, end).
void set_colors(const scene::Scene& scene, const atlas::Atlas& atlas, const atlas::TexelMap& map,
                size_t begin, size_t end, Elements& e) {
  for (size_t i = begin; i < end; ++i) {
    const atlas::Texel& texel = map.texels[i];
    const bool varies = varies_over_texels(scene::material_at(scene, texel.sample));
    const auto color = [&](ColorAt color_at) {
      return varies ? mean_over_texel(scene, atlas, texel, color_at)
                    : color_at(scene, texel.sample);
    };
    e.reflectance[i] = color(scene::reflectance_at);
    if (!e.transmittance.empty()) e.transmittance[i] = color(scene::diffuse_transmittance_at);
  }
}

}  // namespace

Elements elements_from_texels(const scene::Scene& scene, const atlas::Atlas& atlas,
                              const atlas::TexelMap& map) {
  Elements e = places_of(scene, map);
  parallel_for(e.size(), 4096,
               [&](size_t begin, size_t end) { set_colors(scene, atlas, map, begin, end, e); });
  return e;
}

Result<Elements> elements_together(const scene::Scene& scene, const atlas::Atlas& atlas,
                                   const atlas::TexelMap& map, Team* team, Progress& progress) {
  constexpr size_t kGrain = 4096;
  Elements e = places_of(scene, map);
  progress.begin("surfaces", (e.size() + kGrain - 1) / kGrain);
  const auto work = [&](size_t begin, size_t end) { set_colors(scene, atlas, map, begin, end, e); };
  if (e.transmittance.empty()) {
    LUXEL_TRY_STATUS(
        share_ranges(team, e.size(), kGrain, progress, work, std::span<Rgb>(e.reflectance)));
  } else {
    LUXEL_TRY_STATUS(share_ranges(team, e.size(), kGrain, progress, work,
                                  std::span<Rgb>(e.reflectance), std::span<Rgb>(e.transmittance)));
  }
  return e;
}

}  // namespace luxel::transport
