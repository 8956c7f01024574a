// Light that one point gathers from all faces.
#pragma once

#include "luxel/solve/hierarchical/source_sampler.h"

namespace luxel::hierarchical {

struct GatheringParams {
  /// The error that the light of one source may have [W/m^2]. Few rays replace closed forms at dim
  /// sources, and at clusters of them: the dimmer, the fewer.
  double limit = 0;
  /// E of the background over the whole hemisphere; above 0 every face counts, for what it hides of
  /// that.
  double sky = 0;
};

/// One object per thread: it keeps its memory from point to point.
class Gathering {
 public:
  Gathering(const Solution& solution, const trace::RayTracer& tracer, const RaySources& sources,
            const GatheringParams& params)
      : s_(solution), params_(params), sampler_(solution, tracer, sources) {
    casts_.resize(solution.blockers.all.size());
    scratch_.keeps_shadows = true;
  }

  /// E from all faces. With `list` every source is looked at exactly, and what is seen of each is
  /// appended.
  Rgb from_faces(const Receiver& at, std::vector<Seen>* list);
  /// The share of the hemisphere that faces cover, where every face counts.
  double covered() const { return covered_; }

 private:
  struct Part;
  void visit(uint32_t id);
  bool take_cluster(uint32_t id);
  void visit_root(uint32_t id);
  void look_exactly(size_t index, PolygonView polygon, double whole, bool shines);
  void look_by_rays(size_t index, double whole, bool shines);
  double rays_for(double light) const;
  double at_stake(size_t index, double whole, bool shines) const;
  PolygonView above_horizon(PolygonView polygon);
  viewfactor::SeenFactor look(PolygonView polygon, std::span<const uint32_t> blockers);
  template <class Take>
  void look_again(PolygonView part, std::span<const uint32_t> blockers, const Take& take);
  std::vector<uint32_t> casters(std::span<const uint32_t> blockers) const;
  void add_element(size_t index, const viewfactor::SeenFactor& seen,
                   std::span<const uint32_t> blockers);
  void add_part(const Part& part, const viewfactor::SeenFactor& seen,
                std::span<const uint32_t> blockers, int cuts);
  Rgb radiosity_seen(const Part& part, DVec3 middle) const;

  const Solution& s_;
  GatheringParams params_;
  SourceSampler sampler_;
  Receiver at_;
  Plane horizon_;
  bool turned_ = false;  ///< the source shows its back
  Rgb sum_{};
  double covered_ = 0;
  std::vector<Seen>* list_ = nullptr;
  std::vector<uint32_t> first_;
  Polygon above_;  ///< what above_horizon() clipped last
  std::vector<uint8_t> casts_;
  viewfactor::VisibilityScratch scratch_;
};

}  // namespace luxel::hierarchical
