#include "luxel/solve/hierarchical/source_sampler.h"

#include <algorithm>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"

namespace luxel::hierarchical {

RaySources ray_sources(const Solution& s) {
  const size_t roots = s.tree.first_root.back();
  RaySources out{std::vector<uint32_t>(roots), {0}};
  for (uint32_t r = 0; r < roots; ++r) out.root_of_rank[s.tree.rank[r]] = r;
  for (const uint32_t r : out.root_of_rank) {
    const Element& e = s.tree.elements[r];
    out.power_before.push_back(out.power_before.back() +
                               e.area_m2 * double(max_component(s.light.elements[r].radiosity)));
  }
  return out;
}

SourceSampler::SourcePoint SourceSampler::source_point(size_t element, uint32_t k) const {
  const Element& e = s_.tree.elements[element];
  const auto& c = e.corner;
  const auto& b = s_.light.elements[element].shining;
  const Vec2 u = sobol_owen_2d(k, hash64(element));
  if (e.corners == 3) {
    const Barycentric w = triangle_sample(u);
    return {linear_at(c, 3, w.u, w.v), e.face, linear_at(b, 3, w.u, w.v), 1};
  }
  const double x = double(u.x), y = double(u.y);
  const DVec3 du = (c[1] - c[0]) * (1 - y) + (c[2] - c[3]) * y;
  const DVec3 dv = (c[3] - c[0]) * (1 - x) + (c[2] - c[1]) * x;
  return {linear_at(c, 4, u.x, u.y), e.face, linear_at(b, 4, u.x, u.y), length(cross(du, dv))};
}

/// Adds a ray, and returns cos cos / r^2 of its ends; 0, and no ray, where the place is below the
/// horizon or turns its back.
double SourceSampler::add_shadow_ray(const Receiver& from, const SourcePoint& place) {
  const DVec3 d = place.position - from.position;
  const double r2 = dot(d, d);
  const Face& face = s_.faces.faces[place.face];
  const double facing = -dot(d, face.plane.normal);
  const double kernel = std::abs(facing) * dot(d, from.normal) / (r2 * r2);
  if (dot(d, from.geometric_normal) <= 0 || (facing <= 0 && !face.two_sided) || !(kernel > 0))
    return 0;
  const DVec3 side = facing > 0 ? face.plane.normal : -face.plane.normal;
  const Vec3 begin = from.start();
  const Vec3 end = scene::off_surface(to_float(place.position), to_float(side), face.size_m);
  rays_.push_back({begin, 0, end - begin, 1});
  return kernel;
}

void SourceSampler::trace_rays() {
  blocked_.resize(rays_.size());
  tracer_.occluded(rays_, blocked_);
}

SourceSampler::Sample SourceSampler::sample_element(const Receiver& from, size_t element,
                                                    uint32_t rays) {
  rays_.clear(), weight_.clear(), radiosity_.clear();
  for (uint32_t k = 0; k < rays; ++k) {
    const SourcePoint place = source_point(element, k);
    const double kernel = add_shadow_ray(from, place);
    if (kernel > 0)
      weight_.push_back(float(kernel * place.area)), radiosity_.push_back(place.radiosity);
  }
  trace_rays();
  float all = 0, seen = 0;
  Rgb light{};
  for (size_t k = 0; k < rays_.size(); ++k) {
    all += weight_[k];
    if (blocked_[k]) continue;
    seen += weight_[k], light += radiosity_[k] * weight_[k];
  }
  return all > 0 ? Sample{double(seen / all), max(light / all, Rgb{})} : Sample{};
}

Rgb SourceSampler::irradiance_from_cluster(const Receiver& from, uint32_t cluster, uint32_t rays) {
  rays_.clear(), radiosity_.clear();
  const Cluster& c = s_.tree.clusters[cluster];
  const auto begin = sources_.power_before.begin() + c.first;
  const auto end = sources_.power_before.begin() + c.end;
  const double each = (*end - *begin) / rays;
  for (uint32_t k = 0; k < rays; ++k) {
    const auto rank =
        size_t(std::upper_bound(begin + 1, end, *begin + each * (k + 0.5)) - begin) - 1 + c.first;
    const uint32_t root = sources_.root_of_rank[std::min<size_t>(rank, c.end - 1)];
    const SourcePoint place = source_point(root, k);
    const double kernel = add_shadow_ray(from, place);
    if (kernel > 0)
      radiosity_.push_back(
          place.radiosity *
          float(kernel * each /
                (kPiDouble * double(max_component(s_.light.elements[root].radiosity)))));
  }
  trace_rays();
  Rgb light{};
  for (size_t k = 0; k < rays_.size(); ++k)
    if (!blocked_[k]) light += max(radiosity_[k], Rgb{});
  return light;
}

}  // namespace luxel::hierarchical
