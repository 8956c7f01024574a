#include "luxel/pipeline/bake/light_directions.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "luxel/base/shown_text.h"
#include "luxel/export/baked_glb.h"
#include "luxel/image/codec.h"
#include "luxel/post/dilate.h"
#include "luxel/scene/origin.h"
#include "luxel/transport/own_side.h"

namespace luxel::pipeline {
namespace {

/// A probe around which more than this share of the surfaces is seen from behind stands in a solid.
constexpr float kInsideSolid = 0.5f;

/// Rays read the lightmap on their own side of every wall. Refers to its arguments.
light::LitScene lit_scene(const light::TexelScene& in, const transport::OwnSides& sides,
                          std::span<const Rgb> irradiance) {
  return {in.scene, in.tracer, in.lights, [&sides, irradiance](const scene::SurfacePoint& p) {
            return transport::own_irradiance_at(sides, irradiance, p);
          }};
}

/// V's luminance over that of E: one vector for all channels.
Rgb dominant_of(const light::Bent& bent, Rgb irradiance) {
  const float e = luminance(irradiance);
  if (!(e > 0)) return {};
  const Rgb w = Rgb{luminance(bent.v[0]), luminance(bent.v[1]), luminance(bent.v[2])} / e;
  return is_finite(w) ? w : Rgb{};
}

}  // namespace

Result<DirectionMaps> direction_maps(const light::TexelScene& in, std::span<const Rgb> irradiance,
                                     std::span<const uint8_t> hidden, Directional kind,
                                     uint64_t seed, Progress& progress) {
  const transport::OwnSides sides =
      transport::find_own_sides(in.scene, in.atlas, in.map, in.tracer);
  light::AroundParams params;
  params.samples = 256, params.seed = seed;
  LUXEL_TRY(
      light::BentLight light,
      light::bent_irradiance(lit_scene(in, sides, irradiance), in.elements.position,
                             in.elements.normal, in.elements.geometric_normal, params, progress));
  for (size_t i = 0; i < light.bent.size(); ++i)
    if (hidden[i]) light.bent[i] = {};
  DirectionMaps out;
  out.rays = light.rays;
  const size_t count = kind == Directional::sh1 ? 3 : 1;
  for (size_t k = 0; k < count; ++k) {
    std::vector<Rgb> values(light.bent.size());
    for (size_t i = 0; i < values.size(); ++i)
      values[i] =
          kind == Directional::sh1 ? light.bent[i].v[k] : dominant_of(light.bent[i], irradiance[i]);
    out.pictures.push_back(post::lightmap_pages(in.atlas, in.map, values));
    for (image::Image& page : out.pictures.back()) post::dilate(page, post::kDilationRings);
  }
  return out;
}

Result<std::vector<OutputFile>> direction_files(const DirectionMaps& maps,
                                                const std::filesystem::path& folder) {
  std::vector<OutputFile> out;
  for (size_t k = 0; k < maps.pictures.size(); ++k) {
    const std::string what = maps.pictures.size() == 1 ? "direction" : std::string(1, "xyz"[k]);
    const std::vector<image::Image>& pages = maps.pictures[k];
    for (size_t p = 0; p < pages.size(); ++p) {
      LUXEL_TRY(std::vector<std::byte> exr, image::encode_exr(pages[p]));
      const std::string name = export_::lightmap_name(p, pages.size());
      out.push_back({folder / fmt::format("{}.{}.exr", name, what), std::move(exr)});
    }
  }
  return out;
}

Result<ProbeGrid> probe_grid(const light::TexelScene& in, std::span<const Rgb> irradiance,
                             float spacing_m, uint64_t seed, Progress& progress) {
  const Box3 box = scene::world_bounds(in.scene);
  const Vec3 size = box.upper - box.lower;
  ProbeGrid grid;
  grid.spacing_m = spacing_m;
  double points = 1;
  for (int axis = 0; axis < 3; ++axis) points *= std::floor(double(size[axis]) / spacing_m) + 1;
  if (points > kMostProbes)
    return fail(ErrorCode::bad_setting,
                "--probes {} would place {:.3g} probes in {:.3g} x {:.3g} x {:.3g} m, more than "
                "{:.0f}; ask for a wider spacing",
                spacing_m, points, size.x, size.y, size.z, kMostProbes);
  // In the middle: no probe stands in a wall that ends the scene, unless the grid fits exactly.
  const auto begin = [&](int axis) {
    const int count = int(std::floor(size[axis] / spacing_m)) + 1;
    grid.count[size_t(axis)] = count;
    return box.lower[axis] + 0.5f * (size[axis] - spacing_m * float(count - 1));
  };
  grid.origin = {begin(0), begin(1), begin(2)};
  std::vector<Vec3> positions;
  for (int z = 0; z < grid.count[2]; ++z)
    for (int y = 0; y < grid.count[1]; ++y)
      for (int x = 0; x < grid.count[0]; ++x)
        positions.push_back(grid.origin + Vec3{float(x), float(y), float(z)} * spacing_m);
  const transport::OwnSides sides =
      transport::find_own_sides(in.scene, in.atlas, in.map, in.tracer);
  light::AroundParams params;
  params.samples = 1024, params.seed = seed;
  LUXEL_TRY(light::Probes probes,
            light::light_probes(lit_scene(in, sides, irradiance), positions, params, progress));
  grid.rays = probes.rays;
  for (light::Probe& probe : probes.probes) {
    const bool inside = probe.backs > kInsideSolid;
    grid.row.push_back(inside ? -1 : int32_t(grid.probes.size()));
    if (!inside) grid.probes.push_back(probe);
  }
  return grid;
}

Result<std::vector<OutputFile>> probe_files(const ProbeGrid& grid, DVec3 origin,
                                            const std::filesystem::path& folder) {
  image::Image picture(int(kSh2), std::max(1, int(grid.probes.size())), 3);
  nlohmann::json positions = nlohmann::json::array();
  for (size_t i = 0; i < grid.probes.size(); ++i) {
    for (size_t k = 0; k < kSh2; ++k) picture.set_rgb(int(k), int(i), grid.probes[i].irradiance[k]);
    const DVec3 p = scene::in_world(origin, grid.probes[i].position);
    positions.push_back({p.x, p.y, p.z});
  }
  const DVec3 first = scene::in_world(origin, grid.origin);
  const nlohmann::json json = {
      {"content",
       "irradiance as real spherical harmonics of bands 0 to 2: row i of probes.exr has the nine "
       "coefficients of probe i"},
      {"basis", {"1", "y", "z", "x", "xy", "yz", "3z^2-1", "xz", "x^2-y^2"}},
      {"origin", {first.x, first.y, first.z}},
      {"spacing", grid.spacing_m},
      {"count", grid.count},
      {"row", grid.row},
      {"position", positions}};
  LUXEL_TRY(std::vector<std::byte> exr, image::encode_exr(picture));
  std::vector<OutputFile> out;
  out.push_back({folder / "probes.exr", std::move(exr)});
  out.push_back(text_file(folder / "probes.json", json_text(json, 2) + "\n"));
  return out;
}

}  // namespace luxel::pipeline
