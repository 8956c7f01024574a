#include "luxel/pipeline/texels/two_sides.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "luxel/atlas/keep_uv.h"
#include "luxel/base/disjoint_sets.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/position_numbers.h"
#include "luxel/scene/sides.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::pipeline {
namespace {

constexpr uint32_t kWalks = 64, kSteps = 4;
/// Walks from the inside of an open box get out more often than this, those that slip through the
/// joints of a closed one far less.
constexpr double kOpenShare = 0.1;
/// The reach of a shell's surroundings beyond its box, relative to the box's diagonal.
constexpr float kSurroundings = 0.1f;
/// At most so many of a mesh's instances are looked at.
constexpr size_t kMostPlaces = 4;

/// The parts of a mesh that hang together by their corners.
struct Shells {
  std::vector<uint32_t> of_triangle;
  std::vector<Box3> bounds;     ///< object space
  std::vector<uint8_t> closed;  ///< every edge has triangles on both sides
  std::vector<double> volume;   ///< of a closed one: below 0 if fronts face inwards
  std::vector<std::vector<uint32_t>> candidates;  ///< triangles that may need a back
};

/// A surface that scatters light through itself is lit on both sides, inside of lampshades as well.
bool scatters(const scene::Scene& scene, const scene::Mesh& mesh, uint32_t triangle) {
  return scene.materials[mesh.triangle_material[triangle]].diffuse_transmission > 0;
}

bool may_need_back(const scene::Scene& scene, const scene::Mesh& mesh, uint32_t triangle) {
  if (!mesh.other_side.empty() && mesh.other_side[triangle] != scene::kNone) return false;
  return scene.materials[mesh.triangle_material[triangle]].double_sided ||
         scatters(scene, mesh, triangle);
}

/// Marks shells with an edge that is run along an odd number of times: their border.
void find_borders(const scene::Mesh& mesh, std::span<const uint32_t> place, Shells& shells) {
  struct Edge {
    uint32_t low, high, shell;
    auto operator<=>(const Edge&) const = default;
  };
  std::vector<Edge> edges;
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = place[mesh.triangles[t][k]], b = place[mesh.triangles[t][(k + 1) % 3]];
      edges.push_back({std::min(a, b), std::max(a, b), shells.of_triangle[t]});
    }
  std::sort(edges.begin(), edges.end());
  for (size_t i = 0; i < edges.size();) {
    const auto end = std::upper_bound(edges.begin() + std::ptrdiff_t(i), edges.end(), edges[i]);
    const size_t count = size_t(end - edges.begin()) - i;
    if (count % 2 == 1) shells.closed[edges[i].shell] = 0;
    i += count;
  }
}

/// The signed volume between a triangle and the origin; the sum over a closed shell is its volume.
double volume_below(const scene::Mesh& mesh, uint32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return dot(to_double(mesh.positions[a]),
             cross(to_double(mesh.positions[b]), to_double(mesh.positions[c]))) /
         6;
}

Shells shells_of(const scene::Scene& scene, const scene::Mesh& mesh) {
  const std::vector<uint32_t> place = scene::position_numbers(mesh.positions);
  std::vector<uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0u);
  for (const auto& [a, b, c] : mesh.triangles)
    for (const uint32_t v : {b, c}) parent[root_of(parent, place[v])] = root_of(parent, place[a]);
  Shells out;
  std::vector<uint32_t> number(mesh.positions.size(), scene::kNone);
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    uint32_t& shell = number[root_of(parent, place[mesh.triangles[t][0]])];
    if (shell == scene::kNone) {
      shell = uint32_t(out.bounds.size());
      out.bounds.emplace_back();
      out.volume.push_back(0);
      out.candidates.emplace_back();
    }
    out.of_triangle.push_back(shell);
    for (const uint32_t v : mesh.triangles[t]) out.bounds[shell].extend(mesh.positions[v]);
    out.volume[shell] += volume_below(mesh, t);
    if (may_need_back(scene, mesh, t)) out.candidates[shell].push_back(t);
  }
  out.closed.assign(out.bounds.size(), 1);
  find_borders(mesh, place, out);
  return out;
}

Box3 moved(const Mat34& m, const Box3& box) {
  Box3 out;
  for (int k = 0; k < 8; ++k)
    out.extend(
        transform_point(m, {k & 1 ? box.upper.x : box.lower.x, k & 2 ? box.upper.y : box.lower.y,
                            k & 4 ? box.upper.z : box.lower.z}));
  return out;
}

bool contains(const Box3& box, Vec3 p) { return max(box.lower, p) == p && min(box.upper, p) == p; }
bool contains(const Box3& box, const Box3& other) {
  return contains(box, other.lower) && contains(box, other.upper);
}

Box3 grown(Box3 box, float by) {
  const Vec3 d{by, by, by};
  return {box.lower - d, box.upper + d};
}

/// The scene as walks look at it.
struct ShellScene {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const std::vector<Shells>& shells;  ///< per mesh
  std::vector<Vec3> light_positions;  ///< of point and spot lights, and on emissive surfaces
  bool sky_shines = false;            ///< light comes from where there is no surface

  const Shells& shells_at(uint32_t instance) const {
    return shells[scene.instances[instance].mesh];
  }
};

/// One shell of one instance.
struct Placed {
  uint32_t instance = 0, shell = 0;
  Box3 box, surroundings;
  bool closed = false;
};

/// The middles of emissive triangles, kMostLamps of them at most.
std::vector<Vec3> lamp_positions(const scene::Scene& scene) {
  constexpr size_t kMostLamps = 256;
  std::vector<Vec3> all;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (max_component(scene.materials[mesh.triangle_material[t]].emission) <= 0) continue;
      const scene::Triangle3 w = scene::world_triangle(scene, i, t);
      all.push_back((w.a + w.b + w.c) * (1.0f / 3));
    }
  }
  std::vector<Vec3> out;
  const size_t count = std::min(all.size(), kMostLamps);
  for (size_t k = 0; k < count; ++k) out.push_back(all[k * all.size() / count]);
  return out;
}

ShellScene shell_scene_of(const scene::Scene& scene, const trace::RayTracer& tracer,
                          const std::vector<Shells>& shells) {
  ShellScene shell_scene{scene, tracer, shells, lamp_positions(scene)};
  shell_scene.sky_shines = max_component(scene.background) > 0 || !scene.environment.empty();
  for (const scene::PunctualLight& light : scene.lights)
    if (scene::has_position(light.kind))
      shell_scene.light_positions.push_back(light.position);
    else
      shell_scene.sky_shines = true;
  return shell_scene;
}

enum class Verdict : uint8_t { on, out, stuck };

Verdict judge(const ShellScene& shell_scene, const Placed& own, const trace::Ray& ray,
              const trace::Hit& hit) {
  if (!hit.found()) return shell_scene.sky_shines ? Verdict::out : Verdict::stuck;
  if (hit.back_face && !scene::reflects_from_behind(material_at(shell_scene.scene, hit.point())))
    return Verdict::stuck;
  const Vec3 p = ray.origin + ray.direction * hit.t;
  if (!contains(own.surroundings, p))
    return !own.closed || !hit.back_face ? Verdict::out : Verdict::on;
  const Shells& shells = shell_scene.shells_at(hit.instance);
  const uint32_t shell = shells.of_triangle[hit.triangle];
  if (hit.back_face || (hit.instance == own.instance && shell == own.shell)) return Verdict::on;
  const Mat34& m = shell_scene.scene.instances[hit.instance].world_from_object;
  return contains(own.box, moved(m, shells.bounds[shell])) ? Verdict::out : Verdict::on;
}

trace::Ray ray_from(const ShellScene& shell_scene, const scene::SurfacePoint& p, Vec3 side,
                    RandomStream& random) {
  const Vec3 origin = scene::off_surface(shell_scene.scene, p, side);
  const Vec3 d = frame_around(side).to_world(cosine_hemisphere_sample(random.next2()));
  return {origin, 0, d, INFINITY};
}

/// True: one of some randomly chosen lights with a position is seen from `origin`. The ray ends
/// just short of the light, where the lamp's own surface may be.
bool sees_light(const ShellScene& shell_scene, Vec3 origin, Vec3 side, RandomStream& random) {
  // Each lamp is mostly behind the others, and most triangles of a lantern face away.
  constexpr int kTries = 8;
  const std::vector<Vec3>& lights = shell_scene.light_positions;
  if (lights.empty()) return false;
  for (int i = 0; i < kTries; ++i) {
    const size_t k = std::min(size_t(random.next() * float(lights.size())), lights.size() - 1);
    const Vec3 towards = lights[k] - origin;
    if (dot(towards, side) > 0 &&
        !shell_scene.tracer.closest_hit({origin, 0, towards, 0.999f}).found())
      return true;
  }
  return false;
}

/// True: a walk from the back of a triangle gets out, or a light shines on that back.
bool gets_out(const ShellScene& shell_scene, const Placed& own, const scene::SurfacePoint& from,
              RandomStream& random) {
  const Vec3 behind = -scene::front_normal(shell_scene.scene, from.instance, from.triangle);
  trace::Ray ray = ray_from(shell_scene, from, behind, random);
  if (sees_light(shell_scene, ray.origin, behind, random)) return true;
  for (uint32_t step = 0; step < kSteps; ++step) {
    const trace::Hit hit = shell_scene.tracer.closest_hit(ray);
    const Verdict what = judge(shell_scene, own, ray, hit);
    if (what != Verdict::on) return what == Verdict::out;
    const Vec3 front = scene::front_normal(shell_scene.scene, hit.instance, hit.triangle);
    ray = ray_from(shell_scene, hit.point(), hit.back_face ? -front : front, random);
  }
  return false;
}

/// The share of walks that get out, from points spread over the candidates in proportion to area.
double share_out(const ShellScene& shell_scene, const Placed& own, uint64_t seed) {
  const std::vector<uint32_t>& candidates =
      shell_scene.shells_at(own.instance).candidates[own.shell];
  std::vector<double> below{0};
  for (const uint32_t t : candidates)
    below.push_back(below.back() +
                    double(area_m2(scene::world_triangle(shell_scene.scene, own.instance, t))));
  uint32_t out = 0;
  for (uint32_t k = 0; k < kWalks; ++k) {
    RandomStream random{hash64(seed, k)};
    const double at = (double(k) + double(random.next())) / kWalks * below.back();
    const auto found = std::upper_bound(below.begin() + 1, below.end() - 1, at);
    const uint32_t t = candidates[size_t(found - below.begin()) - 1];
    out += gets_out(shell_scene, own, {own.instance, t, triangle_sample(random.next2())}, random);
  }
  return double(out) / kWalks;
}

/// Shells of instances to look at: all that have candidates, in some of a mesh's places.
std::vector<Placed> placed_shells(const scene::Scene& scene, const std::vector<Shells>& shells) {
  std::vector<std::vector<uint32_t>> places(scene.meshes.size());
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    places[scene.instances[i].mesh].push_back(i);
  std::vector<Placed> out;
  for (size_t m = 0; m < shells.size(); ++m)
    for (size_t k = 0; k < std::min(kMostPlaces, places[m].size()); ++k) {
      const uint32_t i = places[m][k * places[m].size() / std::min(kMostPlaces, places[m].size())];
      for (uint32_t s = 0; s < shells[m].bounds.size(); ++s) {
        if (shells[m].candidates[s].empty()) continue;
        const Box3 box = moved(scene.instances[i].world_from_object, shells[m].bounds[s]);
        out.push_back(
            {i, s, box, grown(box, kSurroundings * box.diagonal()), shells[m].closed[s] != 0});
      }
    }
  return out;
}

bool may_be_kept(const WrongSides& wrong) { return wrong.shown <= kMostShownWrong; }

/// A share that was counted at a thousand points, to the digits that this knows.
std::string rough_percent(double share) {
  return share < 0.1 ? fmt::format("{:.2g} %", 100 * share) : fmt::format("{:.0f} %", 100 * share);
}

/// Warnings about a valid TEXCOORD_1 and `count` triangles with open backs.
std::vector<std::string> what_uv1_shows(size_t count, const std::optional<WrongSides>& wrong) {
  if (!wrong)
    return {fmt::format(
        "{} double-sided triangles get light on both sides, but have one place in TEXCOORD_1: "
        "their backs show the light of their fronts; --uv unwrap gives each side its own place",
        count)};
  if (!may_be_kept(*wrong))
    return {fmt::format(
        "TEXCOORD_1 is not kept: it has one place for both sides of double-sided surfaces, so {} "
        "of it would show the light of the wrong side; --uv keep keeps it anyway",
        rough_percent(wrong->shown))};
  if (wrong->all == 0) return {};
  return {fmt::format(
      "TEXCOORD_1 has one place for both sides of double-sided surfaces: seen from behind, {} of "
      "it shows the light of the front; --uv unwrap gives each side its own place",
      rough_percent(wrong->all))};
}

/// Flags of triangles, one vector per mesh, empty for meshes without double-sided ones.
struct BackSides {
  std::vector<std::vector<uint8_t>> open;
  std::vector<std::vector<uint8_t>> solid;  ///< of opaque closed shells that nothing is inside of
};

/// Errors: cancelled, no memory for the ray tracer.
Result<BackSides> look_behind(const scene::Scene& scene, Progress& progress) {
  BackSides out;
  out.open.resize(scene.meshes.size()), out.solid.resize(scene.meshes.size());
  const bool any = std::any_of(scene.meshes.begin(), scene.meshes.end(), [&](const auto& mesh) {
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
      if (may_need_back(scene, mesh, t)) return true;
    return false;
  });
  if (!any) return out;
  std::vector<Shells> shells(scene.meshes.size());
  parallel_for(shells.size(), 1, [&](size_t begin, size_t end) {
    for (size_t m = begin; m < end; ++m) shells[m] = shells_of(scene, scene.meshes[m]);
  });
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  const ShellScene shell_scene = shell_scene_of(scene, tracer, shells);
  const std::vector<Placed> placed = placed_shells(scene, shells);
  progress.begin("sides", placed.size());
  std::vector<uint8_t> open(placed.size());
  parallel_for(placed.size(), 16, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end && !progress.cancelled(); ++k)
      open[k] = share_out(shell_scene, placed[k], k) >= kOpenShare;
    progress.advance(end - begin);
  });
  LUXEL_TRY_STATUS(stopped(progress));
  for (size_t k = 0; k < placed.size(); ++k) {
    const uint32_t m = scene.instances[placed[k].instance].mesh, shell = placed[k].shell;
    const scene::Mesh& mesh = scene.meshes[m];
    out.open[m].resize(mesh.triangles.size()), out.solid[m].resize(mesh.triangles.size());
    for (const uint32_t t : shells[m].candidates[shell]) {
      out.open[m][t] |= open[k] || scatters(scene, mesh, t);
      out.solid[m][t] = !out.open[m][t] && shells[m].closed[shell] && shells[m].volume[shell] > 0 &&
                        !scene::lets_light_through(scene.materials[mesh.triangle_material[t]]);
    }
  }
  return out;
}

}  // namespace

Result<std::vector<std::vector<uint8_t>>> open_backs(const scene::Scene& scene,
                                                     Progress& progress) {
  LUXEL_TRY(BackSides backs, look_behind(scene, progress));
  return std::move(backs.open);
}

Result<atlas::UvMode> settle_uv(const scene::Scene& scene, const SidesParams& params,
                                std::vector<std::string>& warnings, const Progress& progress) {
  const bool any = std::ranges::any_of(scene.instances, [&](const scene::Instance& instance) {
    return !scene.meshes[instance.mesh].uv1.empty();
  });
  if (!any || params.uv == atlas::UvMode::unwrap) return params.uv;
  std::string why = "it describes one page";
  if (params.one_page) {
    const auto kept = atlas::keep_uv1(scene, params.resolution, progress);
    LUXEL_TRY_STATUS(stopped(progress));
    if (kept) {
      LUXEL_TRY(why, atlas::why_no_layout(scene, *kept, progress));
      if (why.empty()) return params.uv;
    } else {
      why = kept.error().message;
    }
  }
  if (params.uv == atlas::UvMode::keep) {
    warnings.push_back("--uv keep: " + why);
    return params.uv;
  }
  warnings.push_back("TEXCOORD_1 is not kept: " + why + "; a new layout takes its place");
  return atlas::UvMode::unwrap;
}

Result<Sides> split_sides(scene::Scene& scene, const SidesParams& params, Progress& progress) {
  Sides out{params.uv, {}, {}};
  LUXEL_TRY(const BackSides backs, look_behind(scene, progress));
  for (uint32_t m = 0; m < backs.solid.size(); ++m)
    if (!backs.solid[m].empty()) scene::make_one_sided(scene, m, backs.solid[m]);
  const std::vector<std::vector<uint8_t>>& open = backs.open;
  size_t count = 0;
  for (const auto& flags : open) count += size_t(std::count(flags.begin(), flags.end(), 1));
  if (count == 0) return out;
  const bool may_keep = params.uv == atlas::UvMode::keep ||
                        (params.uv == atlas::UvMode::automatic && params.one_page &&
                         atlas::keep_uv1(scene, params.resolution, progress).has_value());
  LUXEL_TRY_STATUS(stopped(progress));
  if (may_keep) {
    if (params.uv == atlas::UvMode::automatic) {
      LUXEL_TRY(out.wrong_in_uv1, wrong_sides(scene, open, params.light_is, progress));
    }
    out.warnings = what_uv1_shows(count, out.wrong_in_uv1);
    if (!out.wrong_in_uv1 || may_be_kept(*out.wrong_in_uv1)) return out;
  }
  out.uv = atlas::UvMode::unwrap;
  for (uint32_t m = 0; m < open.size(); ++m)
    if (!open[m].empty()) scene::add_backs(scene, m, open[m]);
  return out;
}

std::vector<uint32_t> one_sided_copies(std::span<const std::vector<uint32_t>> before, size_t known,
                                       const scene::Scene& after) {
  std::vector<uint32_t> out(after.materials.size() - known);
  // Backs come after all triangles that were there.
  for (size_t m = 0; m < before.size(); ++m)
    for (size_t t = 0; t < before[m].size(); ++t)
      if (const uint32_t copy = after.meshes[m].triangle_material[t]; copy >= known)
        out[copy - known] = before[m][t];
  return out;
}

}  // namespace luxel::pipeline
