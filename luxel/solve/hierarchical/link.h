// Links: how one element or cluster lights another.
#pragma once

#include "luxel/solve/hierarchical/blockers.h"
#include "luxel/solve/hierarchical/light.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::hierarchical {

/// Light from `source`, kept with its receiver. Between elements E = factor B; to or from a cluster
/// E = factor (what the source sends along -direction) [W], on the receiving element, or on a
/// surface that faces the source when the receiver is a cluster.
struct Link {
  uint32_t source = 0;
  float factor = 0;  ///< mean form factor of what is visible, or visible / (pi d^2) [1/m^2]
  /// Between elements: E at the receiver's corner a is to[a] sum_b from[b] B_b, B_b at those of the
  /// source; linear between corners. The sum of `from` is 1, the mean of `to` is the factor.
  std::array<float, 4> to = {}, from = {};
  float spread = 0;     ///< how far it is from linear over the receiver; of clusters: all of it;
                        ///< INFINITY: too near for that, and `factor` a guess, or INFINITY too
  float visible = 1;    ///< share of the unoccluded exchange
  Vec3 direction = {};  ///< unit, from the receiver to the source, where one is a cluster
  /// Faces that may stand between two elements.
  std::vector<uint32_t> blockers = {};
  bool crowded = false;  ///< more than kMostBlockers do: the list is empty
};

/// Beyond so many, points look at all of them no longer: rays decide.
inline constexpr size_t kMostBlockers = 48;

/// The basis of light over elements. Linear pays (docs/method/hierarchical.md); the others are
/// there to show it.
enum class Basis : uint8_t {
  constant,          ///< as [Hanrahan91; Hardt96] have it
  linear_receivers,  ///< what arrives is linear, what is sent constant
  linear
};

/// The scene and settings that links are made from.
struct Exchange {
  const Faces& faces;
  const Tree& tree;
  const Blockers& blockers;
  const trace::RayTracer& tracer;
  double unit_area_m2 = 1;  ///< errors count in full on receivers of this size
  Basis basis = Basis::linear;
  bool light_in_gaps = false;  ///< Solution::light_in_gaps
};

/// A link from `source` to `receiver`, different ids of the tree. `parent` is a link between the
/// same or what they are parts of, for its blockers; may be null. With factor 0 they do not see
/// each other.
Link make_link(const Exchange& exchange, uint32_t receiver, uint32_t source, const Link* parent,
               viewfactor::VisibilityScratch& scratch);

/// The value of error_of for a guess: four times the most that may come over a link, whatever
/// stands between. That is all that leaves the source, or what its brightest part would bring to
/// all of the receiver.
float most_error_of(uint32_t source, uint32_t receiver, const Exchange& exchange,
                    const Light& light);
/// A link to or from a cluster that is too near for exchange between points: a guess by eight pairs
/// of points, for so little light that most_error_of is small.
Link guess_link(const Exchange& exchange, uint32_t receiver, uint32_t source);

/// E that the source sends to a receiver over a link [W/m^2].
Rgb irradiance_of(const Link& link, const Exchange& exchange, const Light& light);
/// By how much that may be wrong over the receiver [W/m^2], times the receiver's area over the
/// unit: large receivers count for more.
float error_of(const Link& link, uint32_t receiver, const Exchange& exchange, const Light& light);

/// One step of Jacobi's iteration: what all links bring, to ElementLight::received and
/// ClusterLight::received. `links` per id.
void gather(const Exchange& exchange, std::span<const std::vector<Link>> links, Light& light);

}  // namespace luxel::hierarchical
