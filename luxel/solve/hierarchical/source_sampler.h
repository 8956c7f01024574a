// Shadow rays to a few points of each source that is too dim for closed forms.
#pragma once

#include "luxel/solve/hierarchical/irradiance.h"

namespace luxel::hierarchical {

/// Where rays towards clusters end: at roots, in the order of their ranks, each as often as its
/// power asks for.
struct RaySources {
  std::vector<uint32_t> root_of_rank;
  std::vector<double> power_before;  ///< B A of all before a rank [W]; one extra entry
};
/// Ranks and powers by the light there is.
RaySources ray_sources(const Solution& solution);

/// All points look at the same places of a source, so that what is seen changes only where a shadow
/// passes over one of them. One object per thread: it keeps its memory.
class SourceSampler {
 public:
  SourceSampler(const Solution& solution, const trace::RayTracer& tracer, const RaySources& sources)
      : s_(solution), tracer_(tracer), sources_(sources) {}

  /// The share of the exchange between the point and the source, were nothing in between, that is
  /// seen; and the sum of radiosity over it [W/m^2].
  struct Sample {
    double share = 1;
    Rgb radiosity{};
  };
  Sample sample_element(const Receiver& from, size_t element, uint32_t rays);
  /// E from a cluster [W/m^2], small as it looks from the point: each ray stands for as much power.
  Rgb irradiance_from_cluster(const Receiver& from, uint32_t cluster, uint32_t rays);
  /// B A of the surfaces of a cluster [W].
  double power_of(uint32_t cluster) const {
    const Cluster& c = s_.tree.clusters[cluster];
    return sources_.power_before[c.end] - sources_.power_before[c.first];
  }

 private:
  struct SourcePoint {
    DVec3 position;
    uint32_t face = 0;
    Rgb radiosity;
    double area = 1;  ///< that it stands for, up to a factor
  };
  SourcePoint source_point(size_t element, uint32_t k) const;
  double add_shadow_ray(const Receiver& from, const SourcePoint& place);
  void trace_rays();

  const Solution& s_;
  const trace::RayTracer& tracer_;
  const RaySources& sources_;
  std::vector<trace::Ray> rays_;
  std::vector<float> weight_;
  std::vector<Rgb> radiosity_;
  std::vector<uint8_t> blocked_;
};

}  // namespace luxel::hierarchical
