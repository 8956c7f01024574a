#include "luxel/pipeline/command/relight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "luxel/base/digest.h"
#include "luxel/base/file.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/parallel.h"
#include "luxel/base/process_memory.h"
#include "luxel/base/share_out.h"
#include "luxel/export/baked_glb.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/command/relight_error.h"
#include "luxel/pipeline/reuse/same_work.h"
#include "luxel/pipeline/settings/version.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/pipeline/solver/stage_seconds.h"
#include "luxel/pipeline/texels/two_sides.h"
#include "luxel/post/dilate.h"
#include "luxel/scene/brightness.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/validate.h"
#include "luxel/solve/matrix/codec.h"
#include "luxel/solve/matrix/lxr.h"
#include "luxel/solve/matrix/relighter.h"
#include "luxel/transport/elements.h"

namespace luxel::pipeline {
namespace {

struct CodecName {
  std::string_view name;
  matrix::CodecKind kind;
};
constexpr std::array kCodecs{CodecName{"hierarchical", matrix::CodecKind::hierarchical},
                             CodecName{"lowrank", matrix::CodecKind::lowrank},
                             CodecName{"bc1", matrix::CodecKind::bc1},
                             CodecName{"dense32", matrix::CodecKind::dense32},
                             CodecName{"dense16", matrix::CodecKind::dense16}};
constexpr std::array<std::string_view, 3> kTargets{"texels", "vertices", "none"};

Result<matrix::CodecKind> codec_of(const std::string& name) {
  for (const CodecName& codec : kCodecs)
    if (codec.name == name) return codec.kind;
  return fail(ErrorCode::bad_setting, "--codec {} is not known; choose from: {}", name,
              codec_names());
}

/// Turns the environment map into an even background. False: there was no map.
bool flatten_sky(scene::Scene& scene) {
  if (scene.environment.empty()) return false;
  scene.background += scene::horizontal_irradiance(scene.environment) * (1 / kPi);
  scene.environment = {};
  return true;
}

/// Where light is wanted, and the scene as its file is to have it.
struct Wanted {
  matrix::Target target;
  std::vector<std::byte> glb;
};

/// Any light may come to a scene that has none: what a sky would find behind double-sided surfaces
/// is lit on both sides then.
template <class Do>
auto as_if_lit(scene::Scene& scene, const Do& ask) {
  const Rgb background = scene.background;
  if (!scene::has_light(scene)) scene.background = {1, 1, 1};
  auto out = ask();
  scene.background = background;
  return out;
}

/// Splits the scene's sides. Any light may come: what sees the open is to have texels of its own.
Result<Wanted> texels_of(scene::Scene& scene, const RelightSettings& s,
                         std::vector<std::string>& warnings, Progress& progress) {
  SidesParams params{s.uv, s.resolution, true, LightIs::to_come};
  LUXEL_TRY(params.uv, settle_uv(scene, params, warnings, progress));
  LUXEL_TRY(const Sides sides,
            as_if_lit(scene, [&] { return split_sides(scene, params, progress); }));
  warnings.insert(warnings.end(), sides.warnings.begin(), sides.warnings.end());
  LUXEL_TRY(const atlas::Atlas atlas,
            atlas::make_atlas(scene, {sides.uv, s.resolution, s.texels_per_metre}, progress));
  const atlas::TexelMap map = atlas::rasterise(scene, atlas);
  const transport::Elements elements = transport::elements_from_texels(scene, atlas, map);
  Wanted out;
  out.target.kind = matrix::Target::Kind::texels;
  out.target.width = out.target.height = uint32_t(atlas.resolution);
  for (const atlas::Texel& t : map.texels)
    out.target.texel.push_back({uint16_t(t.x), uint16_t(t.y)});
  out.target.position = copied(elements.position);
  out.target.normal = copied(elements.normal);
  out.target.geometric_normal = copied(elements.geometric_normal);
  // The file's lightmap is black: light comes from the relighter.
  const std::vector<Rgb> dark(map.texels.size());
  LUXEL_TRY(out.glb, export_::baked_glb(scene, atlas, post::lightmap_from_texels(map, dark)));
  return out;
}

/// Vertices of instance after instance, as whoever reads the file's scene numbers them. A vertex of
/// no triangle faces upwards.
matrix::Target vertices_of(const scene::Scene& scene) {
  matrix::Target target;
  target.kind = matrix::Target::Kind::vertices;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    std::vector<Vec3> facing(mesh.positions.size());
    std::vector<float> size_m(mesh.positions.size());  // the largest of its triangles
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const scene::Facet facet = scene::facet_of(scene, i, t);
      for (const uint32_t v : mesh.triangles[t]) {
        facing[v] += facet.front * scene::area_m2(facet.corners);
        size_m[v] = std::max(size_m[v], facet.size_m);
      }
    }
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3 normal = dot(facing[v], facing[v]) > 0 ? normalize(facing[v]) : Vec3{0, 1, 0};
      const Vec3 at = transform_point(scene.instances[i].world_from_object, mesh.positions[v]);
      target.position.push_back(scene::off_surface(at, normal, size_m[v]));
      target.normal.push_back(normal), target.geometric_normal.push_back(normal);
    }
  }
  return target;
}

Result<Wanted> wanted_of(scene::Scene& scene, const RelightSettings& s,
                         std::vector<std::string>& warnings, Progress& progress) {
  if (s.target == "texels") return texels_of(scene, s, warnings, progress);
  Wanted out;
  LUXEL_TRY(out.glb, export_::scene_glb(scene));
  if (s.target == "none") return out;
  LUXEL_TRY(const import::Imported as_read,
            import::import_glb(out.glb, s.scene.string(), {.origin = DVec3{}}));
  out.target = vertices_of(as_read.scene);
  return out;
}

Status fits(const RelightSettings& s) {
  const uint64_t needed =
      resident_bytes() +
      matrix::bytes_of_preparation(s.matrix.patches.count, s.matrix.factors.rays_per_patch);
  const uint64_t given =
      s.max_memory_bytes > 0 ? s.max_memory_bytes : available_bytes() / 5 * 4 + resident_bytes();
  if (needed <= given) return {};
  return fail(ErrorCode::out_of_memory,
              "{} patches with {} rays each need about {} MiB, and {} MiB may be used; lower "
              "--patches or --rays, or raise --max-memory",
              s.matrix.patches.count, s.matrix.factors.rays_per_patch, needed >> 20, given >> 20);
}

nlohmann::json report(const RelightSettings& s, const matrix::RelightData& data, uint64_t bytes,
                      const std::vector<std::string>& warnings, const Progress& progress) {
  return {
      {"version", kVersion},
      {"settings",
       {{"patches", s.matrix.patches.count},
        {"rays", s.matrix.factors.rays_per_patch},
        {"codec", s.codec},
        {"max_error", s.max_error},
        {"bounces", s.bounces},
        {"target", s.target}}},
      {"counts",
       {{"patches", data.size()},
        {"places", data.target.position.size()},
        {"triangles", data.occluders.triangle.size()}}},
      {"bytes", {{"file", bytes}, {"matrix", matrix::bytes_of(data.codec)}}},
      {"codec_error", data.codec_error},
      {"usual_codec_error", data.usual_codec_error},
      {"indirect_error", {{"scene_lights", data.baked_error}, {"point_lights", data.lamp_error}}},
      {"seconds", stage_seconds(progress.stages())},
      {"peak_memory_bytes", peak_resident_bytes()},
      {"warnings", warnings}};
}

}  // namespace

std::string codec_names() {
  std::string names;
  for (const CodecName& codec : kCodecs)
    names += (names.empty() ? "" : ", ") + std::string(codec.name);
  return names;
}

Status check_making(const RelightSettings& s) {
  LUXEL_TRY_STATUS(check_all(matrix_options(), s.matrix));
  LUXEL_TRY(const matrix::CodecKind codec, codec_of(s.codec));
  if (matrix::looks_at_all_pairs(codec) && s.matrix.patches.count > matrix::kMaxDensePatches)
    return fail(ErrorCode::bad_setting,
                "--patches {} are too many for --codec {}, which handles all pairs of up to {}; "
                "give fewer, or --codec hierarchical",
                s.matrix.patches.count, s.codec, matrix::kMaxDensePatches);
  if (std::find(kTargets.begin(), kTargets.end(), s.target) == kTargets.end())
    return fail(ErrorCode::bad_setting,
                "--target {} is not known; choose from: texels, vertices, none", s.target);
  if (!s.outside.ies.empty())
    return fail(ErrorCode::bad_setting,
                "--ies {}={}: .lxr files do not keep light profiles; leave it out",
                s.outside.ies[0].light, s.outside.ies[0].file.string());
  if (!(s.max_error >= 1e-5 && s.max_error <= 1))
    return fail(ErrorCode::bad_setting, "--max-error {} is outside 0.00001 to 1", s.max_error);
  if (s.bounces > 1000)
    return fail(ErrorCode::bad_setting, "--bounces {} is outside 0 to 1000; inf counts all",
                s.bounces);
  BakeSettings map;  // the ranges of a lightmap
  map.resolution = s.resolution, map.texels_per_metre = s.texels_per_metre, map.scene = s.scene;
  map.output = s.output, map.threads = s.threads, map.seed = s.seed;
  return check(map);
}

Status check(const RelightSettings& s) {
  LUXEL_TRY_STATUS(check_making(s));
  if (s.output.extension() != ".lxr")
    return fail(ErrorCode::bad_setting, "-o {}: the name of the file must end in .lxr",
                s.output.string());
  return check_output_file(s.output);
}

Result<Relightable> make_relightable(scene::Scene scene, const RelightSettings& s,
                                     Progress& progress, Team* team) {
  Relightable out;
  if (flatten_sky(scene))
    out.warnings.push_back(
        "the sky of an .lxr file has one colour: the environment map becomes a uniform sky that "
        "lights the ground as much");
  LUXEL_TRY_STATUS(fits(s));
  // The scene in the file lies where its patches do.
  const DVec3 origin = std::exchange(scene.origin, {});
  LUXEL_TRY(Wanted wanted, wanted_of(scene, s, out.warnings, progress));
  scene.origin = origin;
  progress.begin("build ray tracer", 0);
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  matrix::RelightParams params;
  params.patches = s.matrix.patches, params.patches.seed = s.seed;
  params.factors = s.matrix.factors, params.factors.seed = s.seed;
  LUXEL_TRY(params.codec, codec_of(s.codec));
  LUXEL_TRY(params.patches.open_backs,
            as_if_lit(scene, [&] { return open_backs(scene, progress); }));
  params.max_error = float(s.max_error), params.bounces = s.bounces;
  CheckedTarget checked = with_places(std::move(wanted.target), places_to_check(scene, s.seed));
  LUXEL_TRY(out.data, matrix::make_relight_data(scene, tracer, std::move(checked.target), params,
                                                progress, team));
  LUXEL_TRY_STATUS(measure_relight_error(scene, tracer, checked.own, params.factors.rays_per_patch,
                                         s.seed, out.data, progress));
  if (!std::isfinite(out.data.baked_error) || !std::isfinite(out.data.lamp_error))
    return Failure{scene::overflow_at(scene, scene::world_bounds(scene).centre())};
  out.data.scene_glb = std::move(wanted.glb);
  if (out.data.usual_codec_error > s.max_error)
    out.warnings.push_back(
        fmt::format("the codec loses {:.2g}, more than --max-error {:.2g}; give more --rays",
                    out.data.usual_codec_error, s.max_error));
  return out;
}

Result<nlohmann::json> write_relightable(const RelightSettings& s, const Relightable& made,
                                         Progress& progress) {
  progress.begin(kWriteStage, 0);
  const std::vector<std::byte> bytes = matrix::encode_lxr(made.data);
  LUXEL_TRY_STATUS(stopped(progress));
  LUXEL_TRY_STATUS(write_file_atomically(s.output, bytes));
  progress.finish();
  return report(s, made.data, bytes.size(), made.warnings, progress);
}

namespace {

/// A digest of what decides how the work is shared out, and its results.
uint64_t digest_of_settings(const RelightSettings& s) {
  Digest digest;
  digest.add(s.target), digest.add(s.resolution), digest.add(s.texels_per_metre);
  digest.add(int(s.uv)), digest.add(s.matrix.patches.count);
  digest.add(s.matrix.factors.rays_per_patch), digest.add(s.codec), digest.add(s.seed);
  digest.add(s.max_error), digest.add(s.bounces);
  return digest.value();
}

Result<nlohmann::json> relight_alone_or_together(const RelightSettings& s, Team* team,
                                                 Progress& progress) {
  if (!team || team->rank() == 0) LUXEL_TRY_STATUS(check(s));  // who writes the file
  const ThreadLimit threads(s.threads);
  progress.begin("import", 0);
  LUXEL_TRY(import::Imported imported,
            import::import_scene(s.scene, s.reading, s.max_memory_bytes));
  // A scene without light is no mistake here: its lights come later.
  if (s.outside.background || s.outside.environment || s.outside.sun || s.outside.sky)
    LUXEL_TRY_STATUS(add_outside_light(s.outside, imported.scene, {}, s.max_memory_bytes));
  LUXEL_TRY_STATUS(check_same_work(team, imported.scene, digest_of_settings(s), progress));
  LUXEL_TRY(Relightable made, make_relightable(std::move(imported.scene), s, progress, team));
  made.warnings.insert(made.warnings.begin(), imported.warnings.begin(), imported.warnings.end());
  return write_relightable(s, made, progress);
}

}  // namespace

Result<nlohmann::json> relight(const RelightSettings& s, Progress& progress, Team* team) {
  auto done = relight_alone_or_together(s, team, progress);
  if (!done && done.error().code == ErrorCode::parts_missing) return nlohmann::json::object();
  return or_give_up(team, std::move(done));
}

}  // namespace luxel::pipeline
