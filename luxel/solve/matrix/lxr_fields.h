// Fields of the structs of an .lxr file, in the order of the file: docs/format/lxr.md has the same
// lists. A field added, removed or moved makes a new major version of the format (lxr.h). Structs
// are taken apart by name: one with a field more than is listed here does not compile.
#pragma once

#include "luxel/solve/matrix/archive.h"
#include "luxel/solve/matrix/relight_data.h"

namespace luxel::matrix {

template <class Archive>
void fields(Archive& a, Is<Vec3> auto& v) {
  auto& [x, y, z] = v;
  a(x, y, z);
}
template <class Archive>
void fields(Archive& a, Is<DVec3> auto& v) {
  auto& [x, y, z] = v;
  a(x, y, z);
}
template <class Archive>
void fields(Archive& a, Is<PatchPoint> auto& x) {
  auto& [position, normal] = x;
  a(position, normal);
}
template <class Archive>
void fields(Archive& a, Is<Cluster> auto& x) {
  auto& [first, end, child, depth] = x;
  a(first, end, child, depth);
}
template <class Archive>
void fields(Archive& a, Is<Hierarchical::Far> auto& x) {
  auto& [coefficient, scale, sender] = x;
  a(coefficient, scale, sender);
}
template <class Archive>
void fields(Archive& a, Is<Hierarchical::Near> auto& x) {
  auto& [sender, entry, scale] = x;
  a(sender, entry, scale);
}
template <class Archive>
void fields(Archive& a, Is<Hierarchical> auto& x) {
  auto& [clusters, up, phi, area_m2, first_far, far, first_near, near, entries] = x;
  a(clusters, up, phi, area_m2, first_far, far, first_near, near, entries);
}
template <class Archive>
void fields(Archive& a, Is<Dense> auto& x) {
  auto& [n, single, half] = x;
  a(n, single, half);
}
template <class Archive>
void fields(Archive& a, Is<CoarseScene> auto& x) {
  auto& [cluster_of, area_m2, response] = x;
  a(cluster_of, area_m2, response);
}
template <class Archive>
void fields(Archive& a, Is<HierarchicalCodec> auto& x) {
  auto& [matrix, coarse, sweeps] = x;
  a(matrix, coarse, sweeps);
}
template <class Archive>
void fields(Archive& a, Is<DenseCodec> auto& x) {
  auto& [matrix, coarse, sweeps] = x;
  a(matrix, coarse, sweeps);
}
template <class Archive>
void fields(Archive& a, Is<Bc1::Kept> auto& x) {
  auto& [value, place] = x;
  a(value, place);
}
template <class Archive>
void fields(Archive& a, Is<Bc1> auto& x) {
  auto& [n, log_range, row, column, row_scale, column_scale, blocks, kept_unit, first_kept, kept] =
      x;
  a(n, log_range, row, column, row_scale, column_scale, blocks, kept_unit, first_kept, kept);
}
template <class Archive>
void fields(Archive& a, Is<Bc1Codec> auto& x) {
  auto& [matrix] = x;
  a(matrix);
}
template <class Archive>
void fields(Archive& a, Is<LowRank> auto& x) {
  auto& [root_area_m, vector, eigenvalue, reflected, all_bounces] = x;
  a(root_area_m, vector, eigenvalue, reflected, all_bounces);
}
template <class Archive>
void fields(Archive& a, Is<LowRankCodec> auto& x) {
  auto& [matrix] = x;
  a(matrix);
}
template <class Archive>
void fields(Archive& a, Is<Transfer> auto& x) {
  auto& [first, patch, weight] = x;
  a(first, patch, weight);
}
template <class Archive>
void fields(Archive& a, Is<Target> auto& x) {
  auto& [kind, width, height, texel, position, normal, geometric_normal, transfer] = x;
  a(kind, width, height, texel, position, normal, geometric_normal, transfer);
}
template <class Archive>
void fields(Archive& a, Is<Glow> auto& x) {
  auto& [first, material, irradiance] = x;
  a(first, material, irradiance);
}
template <class Archive>
void fields(Archive& a, Is<Occluders> auto& x) {
  auto& [position, triangle] = x;
  a(position, triangle);
}
template <class Archive>
void fields(Archive& a, Is<scene::PunctualLight> auto& x) {
  // make_relight_data refuses lights with profiles: `side` means nothing here.
  [[maybe_unused]] auto& [name, kind, intensity, position, direction, range_m, inner_cone_rad,
                          outer_cone_rad, angular_radius_rad, profile, side] = x;
  a(name, intensity, position, direction, range_m, inner_cone_rad, outer_cone_rad,
    angular_radius_rad, kind);
}

/// Calls visit(tag, minor, fields) for every chunk of a file, in their order; `minor` is the
/// version that added it: files of earlier ones lack it, and earlier programs skip it.
template <class Visit>
void for_each_chunk(Is<RelightData> auto& x, const Visit& visit) {
  [[maybe_unused]] const auto& [position, normal, area_m2, reflectance, emission, sky, material,
                                first_probe, probe, material_name, bounces, glow, codec_error,
                                usual_codec_error, baked_error, lamp_error, codec, target,
                                occluders, lights, background, scene_glb, origin] = x;
  visit("PTCH", 0, [&](auto& a) {
    a(x.position, x.normal, x.area_m2, x.reflectance, x.emission, x.sky, x.material, x.first_probe,
      x.probe);
  });
  visit("MATE", 0, [&](auto& a) { a(x.material_name); });
  visit("CODC", 0, [&](auto& a) { a(x.bounces, x.codec_error, x.codec); });
  visit("TARG", 0, [&](auto& a) { a(x.target); });
  visit("OCCL", 0, [&](auto& a) { a(x.occluders); });
  visit("LAMP", 0, [&](auto& a) { a(x.lights, x.background); });
  visit("GLTF", 0, [&](auto& a) { a(x.scene_glb); });
  visit("GLOW", 1, [&](auto& a) { a(x.glow, x.usual_codec_error, x.baked_error, x.lamp_error); });
  visit("ORIG", 2, [&](auto& a) { a(x.origin); });
}

}  // namespace luxel::matrix
