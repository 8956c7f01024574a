#include "luxel/solve/matrix/relight_check.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <string_view>

#include "luxel/scene/brightness.h"
#include "luxel/scene/held_range.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::matrix {
namespace {

/// Sides of lightmaps: a player makes room for width x height texels.
constexpr uint32_t kLargestMap = 16384;

/// Sweeps of an update: a file cannot ask for hours.
constexpr double kMostSweeps = 64;

Status length_is(std::string_view what, size_t length, size_t wanted) {
  if (length == wanted) return {};
  return fail(ErrorCode::bad_input, "{}: there are {}, there must be {}", what, length, wanted);
}

bool lies_within(double v, double lower, double upper) { return v >= lower && v <= upper; }
bool lies_within(Vec3 v, double lower, double upper) {
  return lies_within(v.x, lower, upper) && lies_within(v.y, lower, upper) &&
         lies_within(v.z, lower, upper);
}
template <size_t N>
bool lies_within(const std::array<float, N>& v, double lower, double upper) {
  return std::all_of(v.begin(), v.end(), [&](float x) { return lies_within(x, lower, upper); });
}

std::string in_words(double v) { return fmt::format("{}", v); }
std::string in_words(Vec3 v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }
template <size_t N>
std::string in_words(const std::array<float, N>& v) {
  return fmt::format("({})", fmt::join(v, ", "));
}

/// Neither NaN nor infinite, too.
template <class List>
Status within(std::string_view what, const List& list, double lower, double upper) {
  for (size_t k = 0; k < list.size(); ++k)
    if (!lies_within(list[k], lower, upper))
      return fail(ErrorCode::bad_input, "{}: number {}, {}, is not in [{}, {}]", what, k,
                  in_words(list[k]), lower, upper);
  return {};
}
/// Checks coordinates of places that rays meet or leave from: larger ones would abort in the ray
/// tracer. Places on surfaces and just off them may round to a little more than the corners have.
template <class List>
Status placed(std::string_view what, const List& list, double room = 1) {
  const double most = double(scene::kFarthest_m) * room;
  return within(what, list, -most, most);
}
constexpr double kRoomOfPlaces = 1.01;
/// B_e = pi L of the brightest surface; means over patches may round to a little more.
constexpr double kMostEmission = 1.01 * double(kPi) * double(scene::kBrightest);
template <class List>
Status finite(std::string_view what, const List& list) {
  return within(what, list, -FLT_MAX, FLT_MAX);
}
template <class List>
Status positive(std::string_view what, const List& list) {
  return within(what, list, FLT_MIN, FLT_MAX);
}

Status below(std::string_view what, std::span<const uint32_t> indices, size_t count) {
  for (size_t k = 0; k < indices.size(); ++k)
    if (indices[k] >= count)
      return fail(ErrorCode::bad_input, "{}: index {} at place {}, there are {}", what, indices[k],
                  k, count);
  return {};
}

/// first[k] to first[k + 1] is the part of k of `owners` in a list of `length`.
Status parts(std::string_view what, std::span<const uint32_t> first, size_t owners, size_t length) {
  LUXEL_TRY_STATUS(length_is(what, first.size(), owners + 1));
  for (size_t k = 0; k < owners; ++k)
    if (first[k] > first[k + 1])
      return fail(ErrorCode::bad_input, "{}: {} is followed by {} at place {}", what, first[k],
                  first[k + 1], k);
  if (first.front() != 0 || first.back() != length)
    return fail(ErrorCode::bad_input, "{}: from {} to {}, must be from 0 to {}", what,
                first.front(), first.back(), length);
  return {};
}

bool are_halves(const Cluster& whole, const Cluster& a, const Cluster& b) {
  return a.first == whole.first && a.end == b.first && b.end == whole.end && a.first < a.end &&
         b.first < b.end && a.depth == whole.depth + 1 && b.depth == whole.depth + 1;
}

/// Halves stand in pairs, in the order of what they are halves of, so that each cluster is the half
/// of one.
Status check(std::span<const Cluster> clusters, size_t patches) {
  if (clusters.empty() || clusters[0].first != 0 || clusters[0].end != patches ||
      clusters[0].depth != 0)
    return fail(ErrorCode::bad_input, "cluster 0: must hold all {} patches", patches);
  uint32_t next = 1;
  for (size_t c = 0; c < clusters.size(); ++c) {
    const Cluster& cluster = clusters[c];
    if (cluster.is_leaf()) {
      if (cluster.size() > kLeafSize)
        return fail(ErrorCode::bad_input, "cluster {}: a leaf of {} patches, {} are allowed", c,
                    cluster.size(), kLeafSize);
      continue;
    }
    if (cluster.child != next || size_t(next) + 1 >= clusters.size() || next <= c ||
        !are_halves(cluster, clusters[next], clusters[next + 1]))
      return fail(ErrorCode::bad_input, "cluster {}: {} and the next are not its halves", c,
                  cluster.child);
    next += 2;
  }
  if (next == clusters.size()) return {};
  return fail(ErrorCode::bad_input, "cluster {}: is no half of any", next);
}

Status check_far(const Hierarchical& m) {
  LUXEL_TRY_STATUS(parts("first far block", m.first_far, m.clusters.size(), m.far.size()));
  for (size_t k = 0; k < m.far.size(); ++k)
    if (m.far[k].sender >= m.clusters.size() || !lies_within(m.far[k].scale, 0, FLT_MAX))
      return fail(ErrorCode::bad_input, "far block {}: sender {} of {}, scale {}", k,
                  m.far[k].sender, m.clusters.size(), m.far[k].scale);
  return {};
}

Status check_near(const Hierarchical& m) {
  LUXEL_TRY_STATUS(parts("first near block", m.first_near, m.clusters.size(), m.near.size()));
  for (size_t c = 0; c < m.clusters.size(); ++c)
    for (uint32_t k = m.first_near[c]; k < m.first_near[c + 1]; ++k) {
      const Hierarchical::Near& near = m.near[k];
      const bool leaves = near.sender < m.clusters.size() && m.clusters[near.sender].is_leaf() &&
                          m.clusters[c].is_leaf();
      if (!leaves || !lies_within(near.scale, 0, FLT_MAX))
        return fail(ErrorCode::bad_input, "near block {}: sender {}, receiver {}, scale {}", k,
                    near.sender, c, near.scale);
      const uint64_t end =
          uint64_t(near.entry) + uint64_t(kLeafSize) * m.clusters[near.sender].size();
      if (end > m.entries.size())
        return fail(ErrorCode::bad_input, "near block {}: entries up to {}, there are {}", k, end,
                    m.entries.size());
    }
  return {};
}

constexpr uint16_t kHalfExponent = 0x7c00;  ///< all set: infinite or NaN

}  // namespace

Status check(const Hierarchical& m, size_t patches) {
  LUXEL_TRY_STATUS(check(m.clusters, patches));
  LUXEL_TRY_STATUS(length_is("functions of halves", m.up.size(), m.clusters.size()));
  LUXEL_TRY_STATUS(finite("functions of halves", m.up));
  LUXEL_TRY_STATUS(length_is("functions of patches", m.phi.size(), patches));
  LUXEL_TRY_STATUS(finite("functions of patches", m.phi));
  LUXEL_TRY_STATUS(length_is("areas in the matrix", m.area_m2.size(), patches));
  LUXEL_TRY_STATUS(positive("areas in the matrix", m.area_m2));
  LUXEL_TRY_STATUS(check_far(m));
  return check_near(m);
}

Status check(const Dense& m, size_t patches) {
  LUXEL_TRY_STATUS(length_is("rows of the matrix", m.n, patches));
  const bool is_half = m.single.empty();
  LUXEL_TRY_STATUS(length_is("form factors", m.single.size() + m.half.size(), patches * patches));
  LUXEL_TRY_STATUS(length_is("half precision form factors", m.half.size(),
                             is_half ? patches * patches : size_t(0)));
  LUXEL_TRY_STATUS(finite("form factors", m.single));
  for (size_t k = 0; k < m.half.size(); ++k)
    if ((m.half[k] & kHalfExponent) == kHalfExponent)
      return fail(ErrorCode::bad_input, "form factors: number {} is not finite", k);
  return {};
}

Status check(const LowRank& m, size_t patches) {
  LUXEL_TRY_STATUS(length_is("roots of areas", m.root_area_m.size(), patches));
  LUXEL_TRY_STATUS(positive("roots of areas", m.root_area_m));
  if (m.rank() % kRankLanes != 0)
    return fail(ErrorCode::bad_input, "eigenvalues: there are {}, must be a multiple of {}",
                m.rank(), kRankLanes);
  LUXEL_TRY_STATUS(finite("eigenvalues", m.eigenvalue));
  LUXEL_TRY_STATUS(length_is("entries of eigenvectors", m.vector.size(), patches * m.rank()));
  for (const auto* matrices : {&m.reflected, &m.all_bounces})
    for (const std::vector<float>& channel : *matrices) {
      LUXEL_TRY_STATUS(length_is("bounces of eigenvectors", channel.size(), m.rank() * m.rank()));
      LUXEL_TRY_STATUS(finite("bounces of eigenvectors", channel));
    }
  return {};
}

Status check(const CoarseScene& coarse, size_t patches) {
  LUXEL_TRY_STATUS(length_is("coarse clusters of patches", coarse.cluster_of.size(), patches));
  LUXEL_TRY_STATUS(below("coarse clusters of patches", coarse.cluster_of, coarse.count()));
  LUXEL_TRY_STATUS(positive("areas of coarse clusters", coarse.area_m2));
  for (const std::vector<float>& channel : coarse.response) {
    LUXEL_TRY_STATUS(
        length_is("coarse responses", channel.size(), coarse.count() * coarse.count()));
    LUXEL_TRY_STATUS(finite("coarse responses", channel));
  }
  return {};
}

Status check(const HierarchicalCodec& codec, size_t patches) {
  LUXEL_TRY_STATUS(check(codec.matrix, patches));
  LUXEL_TRY_STATUS(within("sweeps", std::array{double(codec.sweeps)}, 1, kMostSweeps));
  return check(codec.coarse, patches);
}

Status check(const DenseCodec& codec, size_t patches) {
  LUXEL_TRY_STATUS(check(codec.matrix, patches));
  LUXEL_TRY_STATUS(within("sweeps", std::array{double(codec.sweeps)}, 1, kMostSweeps));
  return check(codec.coarse, patches);
}

Status check(const Bc1Codec& codec, size_t patches) {
  LUXEL_TRY_STATUS(length_is("rows of the BC1 matrix", codec.matrix.n, patches));
  if (is_valid(codec.matrix)) return {};
  return fail(ErrorCode::bad_input,
              "its BC1 matrix has lengths, orders or numbers that no such matrix has");
}

Status check(const LowRankCodec& codec, size_t patches) { return check(codec.matrix, patches); }

Status check(const Transfer& map, size_t places, size_t patches) {
  if (places == 0 && map.first.empty()) return length_is("transfer", map.patch.size(), 0);
  LUXEL_TRY_STATUS(parts("transfer", map.first, places, map.patch.size()));
  LUXEL_TRY_STATUS(below("patches of the transfer", map.patch, patches));
  LUXEL_TRY_STATUS(length_is("weights of the transfer", map.weight.size(), map.patch.size()));
  return finite("weights of the transfer", map.weight);
}

Status check(const Target& target, size_t patches) {
  if (uint32_t(target.kind) > uint32_t(Target::Kind::vertices))
    return fail(ErrorCode::bad_input, "target: kind {} is unknown", uint32_t(target.kind));
  const bool texels = target.kind == Target::Kind::texels;
  const size_t places = target.position.size();
  if (target.kind == Target::Kind::none) LUXEL_TRY_STATUS(length_is("places", places, 0));
  if (target.width > kLargestMap || target.height > kLargestMap)
    return fail(ErrorCode::bad_input, "target: a map of {} x {} texels, {} x {} is the largest",
                target.width, target.height, kLargestMap, kLargestMap);
  LUXEL_TRY_STATUS(length_is("texels of places", target.texel.size(), texels ? places : 0));
  for (size_t k = 0; k < target.texel.size(); ++k)
    if (target.texel[k][0] >= target.width || target.texel[k][1] >= target.height)
      return fail(ErrorCode::bad_input, "texels of places: {}, {} at place {}, the map is {} x {}",
                  target.texel[k][0], target.texel[k][1], k, target.width, target.height);
  LUXEL_TRY_STATUS(placed("positions of places", target.position, kRoomOfPlaces));
  for (const std::vector<Vec3>* normal : {&target.normal, &target.geometric_normal}) {
    LUXEL_TRY_STATUS(length_is("normals of places", normal->size(), places));
    LUXEL_TRY_STATUS(finite("normals of places", *normal));
  }
  return check(target.transfer, places, patches);
}

Status check(const Occluders& occluders) {
  LUXEL_TRY_STATUS(placed("corners of occluders", occluders.position));
  for (const std::array<uint32_t, 3>& triangle : occluders.triangle)
    LUXEL_TRY_STATUS(below("triangles of occluders", triangle, occluders.position.size()));
  return {};
}

namespace {

Status check_patches(const RelightData& d) {
  const size_t n = d.size();
  if (n == 0) return fail(ErrorCode::bad_input, "patches: there are none");
  for (const auto& [what, length] : {std::pair{"positions of patches", d.position.size()},
                                     {"normals of patches", d.normal.size()},
                                     {"reflectances of patches", d.reflectance.size()},
                                     {"emissions of patches", d.emission.size()},
                                     {"background of patches", d.sky.size()},
                                     {"materials of patches", d.material.size()}})
    LUXEL_TRY_STATUS(length_is(what, length, n));
  LUXEL_TRY_STATUS(placed("positions of patches", d.position, kRoomOfPlaces));
  LUXEL_TRY_STATUS(finite("normals of patches", d.normal));
  LUXEL_TRY_STATUS(positive("areas of patches", d.area_m2));
  LUXEL_TRY_STATUS(within("reflectances of patches", d.reflectance, 0, 1));
  LUXEL_TRY_STATUS(within("emissions of patches", d.emission, 0, kMostEmission));
  LUXEL_TRY_STATUS(within("background of patches", d.sky, 0, 1));
  return below("materials of patches", d.material, d.material_name.size());
}

/// A file of version 1.0 keeps none.
Status check_glow(const RelightData& d) {
  const Glow& glow = d.glow;
  if (glow.first.empty()) return length_is("glow", glow.material.size(), 0);
  LUXEL_TRY_STATUS(parts("glow", glow.first, d.size(), glow.material.size()));
  LUXEL_TRY_STATUS(below("materials of the glow", glow.material, d.material_name.size()));
  LUXEL_TRY_STATUS(
      length_is("irradiances of the glow", glow.irradiance.size(), glow.material.size()));
  return within("irradiances of the glow", glow.irradiance, 0, FLT_MAX);
}

Status check_probes(const RelightData& d) {
  LUXEL_TRY_STATUS(parts("probes", d.first_probe, d.size(), d.probe.size()));
  const float most = scene::kFarthest_m * float(kRoomOfPlaces);
  for (size_t k = 0; k < d.probe.size(); ++k)
    if (!scene::is_held(d.probe[k].position, most) || !is_finite(d.probe[k].normal))
      return fail(
          ErrorCode::bad_input,
          "probes: number {} at {} with the normal {} is not finite, or its position not in "
          "[-{}, {}]",
          k, in_words(d.probe[k].position), in_words(d.probe[k].normal), most, most);
  return {};
}

Status check_lights(const RelightData& d) {
  for (size_t k = 0; k < d.lights.size(); ++k) {
    const scene::PunctualLight& light = d.lights[k];
    const float brightest =
        scene::has_position(light.kind) ? scene::kMostIntensity : scene::kBrightest;
    const std::array numbers{light.range_m, light.inner_cone_rad, light.outer_cone_rad,
                             light.angular_radius_rad};
    if (!scene::is_known(light.kind) || !is_finite(light.position) || !is_finite(light.direction) ||
        !lies_within(light.intensity, 0, brightest) || !lies_within(numbers, -FLT_MAX, FLT_MAX))
      return fail(ErrorCode::bad_input,
                  "lights: number {} is of no kind, not finite or brighter than {:g}", k,
                  brightest);
    if (!scene::is_held(light.position, scene::kFarthestLight_m))
      return fail(ErrorCode::bad_input,
                  "lights: the position of number {}, {}, is not in [-{}, {}]", k,
                  in_words(light.position), scene::kFarthestLight_m, scene::kFarthestLight_m);
  }
  return within("background", std::array{d.background}, 0, scene::kBrightest);
}

/// "glTF", the first bytes of binary glTF.
Status check_glb(std::span<const std::byte> glb) {
  constexpr std::string_view magic = "glTF";
  const auto same = [](std::byte b, char c) { return b == std::byte(c); };
  if (glb.empty() ||
      (glb.size() >= magic.size() && std::equal(magic.begin(), magic.end(), glb.begin(),
                                                [&](char c, std::byte b) { return same(b, c); })))
    return {};
  return fail(ErrorCode::bad_input, "the scene is not binary glTF");
}

}  // namespace

Status check(const RelightData& d) {
  LUXEL_TRY_STATUS(check_patches(d));
  LUXEL_TRY_STATUS(check_probes(d));
  LUXEL_TRY_STATUS(check_glow(d));
  LUXEL_TRY_STATUS(
      within("error of the codec", std::array{d.codec_error, d.usual_codec_error}, 0, DBL_MAX));
  LUXEL_TRY_STATUS(
      within("errors of indirect light", std::array{d.baked_error, d.lamp_error}, 0, DBL_MAX));
  LUXEL_TRY_STATUS(std::visit([&](const auto& codec) { return check(codec, d.size()); }, d.codec));
  LUXEL_TRY_STATUS(check(d.target, d.size()));
  LUXEL_TRY_STATUS(check(d.occluders));
  LUXEL_TRY_STATUS(check_lights(d));
  LUXEL_TRY_STATUS(placed("origin", std::array{d.origin.x, d.origin.y, d.origin.z}));
  return check_glb(d.scene_glb);
}

}  // namespace luxel::matrix
