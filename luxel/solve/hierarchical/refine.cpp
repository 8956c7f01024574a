#include "luxel/solve/hierarchical/refine.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/scene/off_surface.h"
#include "luxel/solve/hierarchical/surface.h"
#include "luxel/transport/covers.h"

namespace luxel::hierarchical {
namespace {

/// Points of an element of the unit's area, and of small ones, at which textures are looked at.
/// They are scattered: a grid would see no more than some squares of a checkerboard. Too few, and
/// elements of one textured wall differ by chance; the standard deviation of the mean of 1,024
/// points is 3 % of that of the texture, and less because they are spread evenly.
constexpr double kTexturePoints = 1024, kLeastTexturePoints = 32;

/// A link to be divided.
struct Open {
  uint32_t receiver = 0;
  Link link;
};
/// One of the pairs that an open link is divided into.
struct Pair {
  uint32_t receiver = 0, source = 0;
  uint32_t parent = 0;  ///< of the open links
};

bool has_texture(const scene::Scene& scene, const Face& face) {
  const scene::Material& m = scene.materials[face.material];
  const scene::Mesh& mesh = scene.meshes[scene.instances[face.instance].mesh];
  return m.base_color_texture.texture != kNone || m.metallic_texture.texture != kNone ||
         m.emission_texture.texture != kNone || !mesh.colors.empty() || !mesh.alphas.empty();
}

/// Another one for each place, whatever is divided first.
uint64_t seed_of(const Element& e) {
  return hash64(std::bit_cast<uint64_t>(e.centre.x),
                hash64(std::bit_cast<uint64_t>(e.centre.y), std::bit_cast<uint64_t>(e.centre.z)));
}

/// A link that says nothing yet.
Link undivided(uint32_t source) {
  return {.source = source, .factor = INFINITY, .spread = INFINITY};
}

struct Rules {
  const Tree& tree;
  const RefineParams& params;
  double unit_area_m2 = 1;  ///< Exchange::unit_area_m2
  bool full = false;        ///< no more elements

  double radius(uint32_t id) const {
    return tree.is_cluster(id) ? tree.clusters[id].radius_m : tree.element(id).radius_m;
  }
  bool can_divide(uint32_t id) const {
    if (tree.is_cluster(id)) return true;
    const Element& e = tree.element(id);
    return !e.is_leaf() || (!full && e.area_m2 > 4 * params.min_area_m2);
  }
  /// A leaf no larger than the unit. That it is too near to a cluster for exchange between points
  /// divides the cluster, whose parts there are already. Else each small thing on a floor would
  /// divide it to its own size, however little light they exchange.
  bool stays_whole(uint32_t id) const {
    return !tree.is_cluster(id) && tree.element(id).is_leaf() &&
           tree.element(id).area_m2 <= unit_area_m2;
  }
};

enum class Division { none, receiver, source, both };

/// The larger of the two is divided. A source whose parts differ in light is, when that is what
/// makes the error; and a cluster is, when it is too near to a leaf.
Division division_of(const Rules& rules, const Light& light, uint32_t receiver, const Link& link) {
  const Tree& tree = rules.tree;
  const uint32_t source = link.source;
  if (receiver == source) return tree.is_cluster(receiver) ? Division::both : Division::none;
  const bool r = rules.can_divide(receiver), s = rules.can_divide(source);
  if (!r || !s) return r ? Division::receiver : s ? Division::source : Division::none;
  if (!tree.is_cluster(receiver) && !tree.is_cluster(source)) {
    const ElementLight& l = light.elements[source - tree.clusters.size()];
    if (!tree.element(source).is_leaf() && l.rough * link.factor > l.most * link.spread)
      return Division::source;
    return tree.element(receiver).area_m2 >= tree.element(source).area_m2 ? Division::receiver
                                                                          : Division::source;
  }
  if (std::isinf(link.spread) && rules.stays_whole(receiver)) return Division::source;
  if (std::isinf(link.spread) && rules.stays_whole(source)) return Division::receiver;
  return rules.radius(receiver) >= rules.radius(source) ? Division::receiver : Division::source;
}

/// The parts of a cluster or an element, which is divided when it was not.
struct DividedParts {
  std::array<uint32_t, 4> id{};
  uint32_t count = 0;
};
DividedParts divided_parts(Refined& state, const Exchange& x, uint32_t id) {
  if (state.tree.is_cluster(id)) {
    const auto& child = state.tree.clusters[id].child;
    return {{child[0], child[1]}, 2};
  }
  const size_t e = id - state.tree.clusters.size();
  if (state.tree.elements[e].is_leaf()) divide_element(state, x, e);
  const uint32_t first = state.tree.id_of(state.tree.elements[e].child);
  return {{first, first + 1, first + 2, first + 3}, 4};
}

void add_pairs(Refined& state, const Exchange& x, const Open& open, Division division,
               uint32_t parent, std::vector<Pair>& out) {
  const uint32_t r = open.receiver, s = open.link.source;
  if (division == Division::both) {
    const DividedParts parts = divided_parts(state, x, r);
    for (uint32_t i = 0; i < parts.count; ++i)
      for (uint32_t j = 0; j < parts.count; ++j)
        if (i != j || state.tree.is_cluster(parts.id[i]))
          out.push_back({parts.id[i], parts.id[j], parent});
    return;
  }
  const DividedParts parts = divided_parts(state, x, division == Division::receiver ? r : s);
  for (uint32_t i = 0; i < parts.count; ++i)
    out.push_back(division == Division::receiver ? Pair{parts.id[i], s, parent}
                                                 : Pair{r, parts.id[i], parent});
}

/// Links of pairs, from the open links that they are parts of.
std::vector<Link> make_links(const Refined& state, const Exchange& x, const RefineParams& params,
                             std::span<const Pair> pairs, std::span<const Open> open,
                             Progress& progress) {
  std::vector<Link> made(pairs.size());
  parallel_for(pairs.size(), 64, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    viewfactor::VisibilityScratch scratch;
    for (size_t k = begin; k < end; ++k) {
      const auto& [receiver, source, parent] = pairs[k];
      if (receiver == source) {
        made[k] = undivided(receiver);
        continue;
      }
      const Open& from = open[parent];
      const bool inherits =
          !x.tree.is_cluster(from.receiver) && !x.tree.is_cluster(from.link.source);
      made[k] = make_link(x, receiver, source, inherits ? &from.link : nullptr, scratch);
      if (params.guesses && std::isinf(made[k].spread) &&
          double(most_error_of(source, receiver, x, state.light)) <= params.eps)
        made[k] = guess_link(x, receiver, source);
    }
    progress.advance(end - begin);
  });
  return made;
}

/// Divides open links until all have little error, or cannot be divided.
Status settle(Refined& state, const Exchange& x, const RefineParams& params, std::vector<Open> open,
              Progress& progress) {
  while (!open.empty()) {
    LUXEL_TRY_STATUS(stopped(progress));
    // The larger end of each open link is divided, or the link stays as it is.
    Rules rules{state.tree, params, x.unit_area_m2};
    std::vector<Pair> pairs;
    std::vector<Open> divided;
    for (Open& o : open) {
      rules.full = state.tree.elements.size() + 4 > params.max_elements;
      const Division division =
          state.links.count + pairs.size() >= params.max_links && !std::isinf(o.link.factor)
              ? Division::none
              : division_of(rules, state.light, o.receiver, o.link);
      state.links.bounded |= rules.full || state.links.count + pairs.size() >= params.max_links;
      if (division == Division::none) {
        ++state.links.at_least_area, ++state.links.count;
        state.links.of[o.receiver].push_back(std::move(o.link));
        continue;
      }
      add_pairs(state, x, o, division, uint32_t(divided.size()), pairs);
      divided.push_back(std::move(o));
    }
    // Links between the parts: kept where they err by less than eps, else open.
    std::vector<Link> made = make_links(state, x, params, pairs, divided, progress);
    open.clear();
    for (size_t k = 0; k < pairs.size(); ++k) {
      if (made[k].factor == 0 && made[k].spread == 0) continue;
      if (double(error_of(made[k], pairs[k].receiver, x, state.light)) > params.eps) {
        open.push_back({pairs[k].receiver, std::move(made[k])});
        continue;
      }
      ++state.links.count;
      state.links.of[pairs[k].receiver].push_back(std::move(made[k]));
    }
  }
  return {};
}

/// Corners are looked at this far inwards: beside an edge something else may begin.
constexpr double kInwards = 0.1;

/// Something much closer than the element covers its centre and its corners.
bool is_covered(const Exchange& x, const Element& e) {
  if (x.light_in_gaps) return false;
  const Face& face = x.faces.faces[e.face];
  const Vec3 normal = to_float(face.plane.normal);
  const auto size_m = float(std::sqrt(e.area_m2));
  const auto covered_at = [&](DVec3 place) {
    const Vec3 from = scene::off_surface(to_float(place), normal, face.size_m);
    return transport::open_share(x.tracer, from, normal, size_m) < 1;
  };
  if (!covered_at(e.centre)) return false;
  for (uint32_t k = 0; k < e.corners; ++k)
    if (!covered_at(e.corner[k] + (e.centre - e.corner[k]) * kInwards)) return false;
  return true;
}

ElementLight uncovered_light(const scene::Scene& scene, const Exchange& x, const Element& e) {
  ElementLight out;
  const Face& face = x.faces.faces[e.face];
  if (!has_texture(scene, face)) {
    const scene::SurfacePoint p{face.instance, face.triangle, {1.0f / 3, 1.0f / 3}};
    out.reflectance = scene::reflectance_at(scene, p);
    out.emission = scene::emission_at(scene, p) * kPi;
    return out;
  }
  const auto count = uint32_t(
      std::clamp(kTexturePoints * e.area_m2 / x.unit_area_m2, kLeastTexturePoints, kTexturePoints));
  const uint64_t seed = seed_of(e);
  for (uint32_t k = 0; k < count; ++k) {
    const DVec3 place = point_in(e, sobol_owen_2d(k, seed));
    std::optional<scene::SurfacePoint> p;
    if (face.has_holes)
      p = solid_point(x.faces, x.tracer, e.face, place);  // a hole sends nothing
    else
      p = surface_point(scene, x.faces, x.tracer, e.face, place);
    if (!p) continue;
    out.reflectance += scene::reflectance_at(scene, *p);
    out.emission += scene::emission_at(scene, *p) * kPi;
  }
  out.reflectance = out.reflectance / float(count), out.emission = out.emission / float(count);
  return out;
}

}  // namespace

ElementLight bare_light(const scene::Scene& scene, const Exchange& x, const Element& e) {
  ElementLight out = uncovered_light(scene, x, e);
  if (is_covered(x, e)) out.reflectance = {};
  return out;
}

void divide_element(Refined& state, const Exchange& x, size_t element) {
  divide(state.tree, element);
  const ElementLight from = state.light.elements[element];
  const Element whole = state.tree.elements[element];
  for (uint32_t part = 0; part < 4; ++part) {
    ElementLight l = bare_light(state.scene, x, state.tree.elements[whole.child + part]);
    const auto of = [&](const std::array<Rgb, 4>& v) {
      return part_of(v, whole.corners, part, whole.parts);
    };
    l.arriving = of(from.arriving), l.unlinked = of(from.unlinked), l.shining = of(from.shining);
    for (uint32_t k = 0; k < whole.corners; ++k) {
      l.irradiance += (l.arriving[k] + l.unlinked[k]) / float(whole.corners);
      l.radiosity += l.shining[k] / float(whole.corners);
    }
    l.most = max_component(l.radiosity);
    state.light.elements.push_back(l);
    state.links.of.emplace_back();
  }
}

Status link_all(Refined& state, const Exchange& x, const RefineParams& params, Progress& progress) {
  state.links.of.resize(state.tree.size());
  if (state.tree.clusters.empty()) return {};
  progress.begin("link", 0);
  return settle(state, x, params, {{0, undivided(0)}}, progress);
}

Result<size_t> refine(Refined& state, const Exchange& x, const RefineParams& params,
                      Progress& progress) {
  std::vector<Open> open;
  state.links.at_least_area = 0;
  // Links that err too much by the light there is now are taken out.
  const Rules rules{state.tree, params, x.unit_area_m2,
                    state.tree.elements.size() + 4 > params.max_elements};
  for (uint32_t id = 0; id < state.links.of.size(); ++id) {
    auto& links = state.links.of[id];
    size_t kept = 0;
    for (Link& link : links) {
      if (double(error_of(link, id, x, state.light)) > params.eps) {
        if (division_of(rules, state.light, id, link) != Division::none) {
          open.push_back({id, std::move(link)});
          continue;
        }
        ++state.links.at_least_area;
      }
      if (&links[kept] != &link) links[kept] = std::move(link);
      ++kept;
    }
    links.resize(kept);
  }
  // They are divided until their parts do not.
  const size_t count = open.size();
  state.links.count -= count;
  progress.begin("refine", 0);
  LUXEL_TRY_STATUS(settle(state, x, params, std::move(open), progress));
  return count;
}

}  // namespace luxel::hierarchical
