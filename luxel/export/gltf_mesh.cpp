#include "luxel/export/gltf_mesh.h"

#include <algorithm>
#include <compare>
#include <map>

#include "luxel/base/check.h"
#include "luxel/export/tangents.h"

namespace luxel::export_ {
namespace {

using nlohmann::json;

bool needs_uv_set(const scene::Material& m, int set) {
  for (const scene::TextureRef* ref : scene::textures_of(m))
    if (ref->texture != scene::kNone && (ref->uv_set == 1) == (set == 1)) return true;
  return false;
}

/// Use of a primitive's texture coordinates.
struct Texcoords {
  bool lightmapped = false;  ///< TEXCOORD_1 holds the lightmap's
  bool keeps_first = true;   ///< false: the scene's first set only where a texture needs it
};

/// Texture coordinates must be numbered without gaps: a missing TEXCOORD_0 is stood in for by the
/// accessor of TEXCOORD_1.
TexcoordSlots append_texcoords(Glb& glb, const scene::Mesh& mesh, const scene::Material& material,
                               const LightmapVertices& vertices, Texcoords kind, json& attributes) {
  const auto [lightmapped, keeps_first] = kind;
  TexcoordSlots slots{-1, -1};
  if (!mesh.uv0.empty() && (keeps_first || needs_uv_set(material, 0))) {
    attributes["TEXCOORD_0"] =
        append_accessor(glb, std::span<const Vec2>(picked(mesh.uv0, vertices.source)));
    slots[0] = 0;
  }
  if (lightmapped)
    attributes["TEXCOORD_1"] = append_accessor(glb, std::span<const Vec2>(vertices.lightmap));
  // Without a lightmap the second set is kept as it is: it may be one for the lightmap to come.
  if (!mesh.uv1.empty() && (!lightmapped || needs_uv_set(material, 1))) {
    slots[1] = lightmapped ? 2 : 1;
    attributes[lightmapped ? "TEXCOORD_2" : "TEXCOORD_1"] =
        append_accessor(glb, std::span<const Vec2>(picked(mesh.uv1, vertices.source)));
  }
  if (slots[0] < 0 && attributes.contains("TEXCOORD_1"))
    attributes["TEXCOORD_0"] = attributes["TEXCOORD_1"];
  return slots;
}

/// The parts of COLOR_0 that no picture holds.
struct Shown {
  bool colors = true, alphas = true;
};

/// Alpha only where the scene's material counts it.
void append_colors(Glb& glb, const scene::Mesh& mesh, const scene::Material& material,
                   const LightmapVertices& vertices, Shown shown, json& attributes) {
  const bool has_colors = shown.colors && !mesh.colors.empty();
  const bool has_alphas =
      shown.alphas && !mesh.alphas.empty() && material.alpha_mode != scene::AlphaMode::opaque;
  if (!has_colors && !has_alphas) return;
  std::vector<Vec3> colors(vertices.source.size(), Vec3{1, 1, 1});
  if (has_colors) colors = picked(mesh.colors, vertices.source);
  for (Vec3& c : colors) c = min(max(c, Vec3{}), Vec3{1, 1, 1});  // glTF wants no others
  if (!has_alphas) {
    attributes["COLOR_0"] = append_accessor(glb, std::span<const Vec3>(colors));
    return;
  }
  std::vector<std::array<float, 4>> with_alphas;
  for (size_t v = 0; v < colors.size(); ++v)
    with_alphas.push_back({colors[v].x, colors[v].y, colors[v].z, mesh.alphas[vertices.source[v]]});
  attributes["COLOR_0"] = append_accessor(glb, std::span<const std::array<float, 4>>(with_alphas));
}

/// Properties that the triangles of a primitive have in common.
struct Part {
  uint32_t material = 0, page = 0;
  bool attached = true;
  bool mirrored = false;  ///< its normal map, which baked files have tangents for
  friend auto operator<=>(const Part&, const Part&) = default;
};

/// Per material of the scene, where its normal map lies on the mesh.
using NormalMaps = std::map<uint32_t, std::vector<Vec2>>;

json primitive(Glb& glb, MaterialBook& book, const scene::Scene& scene, const scene::Mesh& mesh,
               Part part, const LightmapVertices& vertices, bool lightmapped,
               const NormalMaps& maps) {
  json attributes = json::object();
  attributes["POSITION"] =
      append_accessor(glb, std::span<const Vec3>(picked(mesh.positions, vertices.source)));
  if (!mesh.normals.empty()) {
    std::vector<Vec3> normals = picked(mesh.normals, vertices.source);
    for (Vec3& n : normals)
      if (const float l = length(n); !(std::abs(l - 1) < 1e-3f))  // glTF wants unit normals
        n = l > 0 ? n / l : Vec3{0, 1, 0};
    attributes["NORMAL"] = append_accessor(glb, std::span<const Vec3>(normals));
  }
  if (const auto map = maps.find(part.material); map != maps.end() && !map->second.empty())
    attributes["TANGENT"] = append_accessor(glb, std::span<const std::array<float, 4>>(tangents(
                                                     mesh, map->second, vertices, part.mirrored)));
  const MaterialPlace place{part.page, part.attached};
  const scene::Material& material = shown_material(book, scene, part.material, place);
  // Pictures lie on the charts of both sets: some programs look at the first one, whatever the
  // material says.
  const bool in_pictures = is_in_pictures(book, material, place);
  append_colors(glb, mesh, scene.materials[part.material], vertices,
                {!in_pictures, !in_pictures || book.attach != Attach::combined}, attributes);
  const TexcoordSlots slots = append_texcoords(
      glb, mesh, material, vertices, {lightmapped, !(lightmapped && in_pictures)}, attributes);
  return {{"attributes", std::move(attributes)},
          {"indices", append_indices(glb, vertices.indices)},
          {"material", material_index(glb, book, scene, part.material, slots, place)}};
}

/// A normal map lies on a mesh that has no normals.
bool needs_flat_normals(const MaterialBook& book, const scene::Scene& scene,
                        const scene::Mesh& mesh, const LightmapCoordinates& lightmap) {
  if (lightmap.uv.empty() || !mesh.normals.empty()) return false;
  return std::ranges::any_of(mesh.triangle_material, [&](uint32_t m) {
    const scene::Material& shown = shown_material(book, scene, m, {0, lightmap.attached});
    return shown.normal_texture.texture != scene::kNone;
  });
}

}  // namespace

size_t append_mesh(Glb& glb, MaterialBook& book, const scene::Scene& scene, const scene::Mesh& mesh,
                   const LightmapCoordinates& lightmap) {
  LUXEL_CHECK(!mesh.triangles.empty());
  LUXEL_CHECK(lightmap.uv.empty() || lightmap.uv.size() == mesh.triangles.size());
  LUXEL_CHECK(lightmap.page.size() == lightmap.uv.size());
  if (needs_flat_normals(book, scene, mesh, lightmap))
    return append_mesh(glb, book, scene, with_flat_normals(mesh), lightmap);
  // Triangles by part, parts in the order of their first triangle.
  std::vector<Part> parts;
  std::map<Part, size_t> rank;
  std::vector<std::vector<uint32_t>> triangles_of;
  NormalMaps maps;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Part part{mesh.triangle_material[t], lightmap.page.empty() ? 0 : lightmap.page[t],
              lightmap.attached};
    if (!lightmap.uv.empty()) {
      const auto [map, fresh] = maps.try_emplace(part.material);
      if (fresh)
        map->second = normal_map_places(
            mesh, shown_material(book, scene, part.material, {part.page, part.attached}));
      part.mirrored = !map->second.empty() && is_mirrored(map->second, mesh.triangles[t]);
    }
    const auto [known, fresh] = rank.emplace(part, parts.size());
    if (fresh) {
      parts.push_back(part);
      triangles_of.emplace_back();
    }
    triangles_of[known->second].push_back(t);
  }

  VertexSplitter splitter(mesh.positions.size());
  json primitives = json::array();
  for (size_t k = 0; k < parts.size(); ++k) {
    LightmapVertices vertices;
    for (const uint32_t t : triangles_of[k])
      for (size_t c = 0; c < 3; ++c) {
        const Vec2 place = lightmap.uv.empty() ? Vec2{} : lightmap.uv[t][c];
        vertices.indices.push_back(splitter.vertex(vertices, mesh.triangles[t][c], place));
      }
    primitives.push_back(
        primitive(glb, book, scene, mesh, parts[k], vertices, !lightmap.uv.empty(), maps));
    splitter.start_next_part(vertices);
  }
  json out = {{"primitives", std::move(primitives)}};
  if (!mesh.name.empty()) out["name"] = mesh.name;
  return append(glb, "meshes", std::move(out));
}

}  // namespace luxel::export_
