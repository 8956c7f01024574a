// Every format but glTF and OBJ, through Assimp. Its convention: Y up, right-handed, v grows
// upwards.
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/BaseImporter.h>
#include <assimp/importerdesc.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <map>
#include <stdexcept>

#include "luxel/image/color.h"
#include "luxel/import/assimp_files.h"
#include "luxel/import/assimp_parts.h"
#include "luxel/import/format.h"
#include "luxel/import/nesting.h"
#include "luxel/import/ply.h"
#include "luxel/import/text_lines.h"

namespace Assimp {
/// Debian's Assimp is built with its assertions, and a wrong .fbx or .x that meets one would end
/// the process. The library calls this function through the dynamic linker, which takes ours before
/// its own; Importer::ReadFile catches what is thrown, and ours is then an error like others.
void aiAssertViolation(const char* expression, const char* file, int line) {
  const std::string_view path(file);
  throw std::runtime_error(fmt::format("Assimp does not understand it ({} at {}:{})", expression,
                                       path.substr(path.rfind('/') + 1), line));
}
}  // namespace Assimp

namespace luxel::import {
namespace {

Rgb linear(Rgb c) {
  return {image::linear_from_srgb(c.x), image::linear_from_srgb(c.y), image::linear_from_srgb(c.z)};
}

/// Fills `to` for the vertices of a part that starts at `start`; parts without the attribute get
/// `filling` when another part has it.
template <class T, class Get>
void append(std::vector<T>& to, bool wanted, bool has, size_t start, size_t count, T filling,
            const Get& get) {
  if (!wanted) return;
  to.resize(start + count, filling);
  if (has)
    for (size_t i = 0; i < count; ++i) to[start + i] = get(i);
}

struct Wanted {
  bool normals = false, uv0 = false, uv1 = false, colors = false, alphas = false;
};

void append_part(scene::Mesh& mesh, const aiMesh& part, const Wanted& wanted, bool srgb_colors) {
  const size_t start = mesh.positions.size(), count = part.mNumVertices;
  append(mesh.positions, true, true, start, count, Vec3{},
         [&](size_t i) { return vec3_of(part.mVertices[i]); });
  // A zero normal is later replaced by that of the triangles around it.
  append(mesh.normals, wanted.normals, part.HasNormals(), start, count, Vec3{},
         [&](size_t i) { return vec3_of(part.mNormals[i]); });
  const auto uv = [&](unsigned set) {
    return [&part, set](size_t i) {
      const aiVector3D& v = part.mTextureCoords[set][i];
      return Vec2{v.x, 1 - v.y};
    };
  };
  append(mesh.uv0, wanted.uv0, part.HasTextureCoords(0), start, count, Vec2{}, uv(0));
  append(mesh.uv1, wanted.uv1, part.HasTextureCoords(1), start, count, Vec2{}, uv(1));
  append(mesh.colors, wanted.colors, part.HasVertexColors(0), start, count, Rgb{1, 1, 1},
         [&](size_t i) {
           const aiColor4D& c = part.mColors[0][i];
           return srgb_colors ? linear({c.r, c.g, c.b}) : Rgb{c.r, c.g, c.b};
         });
  append(mesh.alphas, wanted.alphas, part.HasVertexColors(0), start, count, 1.0f,
         [&](size_t i) { return part.mColors[0][i].a; });
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    if (face.mNumIndices != 3) continue;  // triangulated; what is left are points and lines
    mesh.triangles.push_back({uint32_t(start + face.mIndices[0]),
                              uint32_t(start + face.mIndices[1]),
                              uint32_t(start + face.mIndices[2])});
    mesh.triangle_material.push_back(part.mMaterialIndex);
  }
}

/// Meanings that a format gives to parts of its files.
struct Habits {
  bool srgb_colors = false;    ///< vertex colors are display values
  bool facet_normals = false;  ///< normals are those of flat triangles, or 0: they say nothing
};

/// Assimp splits a surface by material; the parts that one node draws belong together.
scene::Mesh merged_mesh(const aiScene& in, const std::vector<unsigned>& parts, const Habits& habits,
                        const scene::Scene& out) {
  Wanted wanted;
  for (const unsigned p : parts) {
    wanted.normals |= in.mMeshes[p]->HasNormals() && !habits.facet_normals;
    wanted.uv0 |= in.mMeshes[p]->HasTextureCoords(0);
    wanted.uv1 |= in.mMeshes[p]->HasTextureCoords(1);
    wanted.colors |= in.mMeshes[p]->HasVertexColors(0);
    wanted.alphas |=
        in.mMeshes[p]->HasVertexColors(0) && counts_alpha(out, in.mMeshes[p]->mMaterialIndex);
  }
  scene::Mesh mesh;
  for (const unsigned p : parts) append_part(mesh, *in.mMeshes[p], wanted, habits.srgb_colors);
  drop_alphas_of_one(mesh);
  join_identical_vertices(mesh);
  return mesh;
}

/// A node that draws something.
struct DrawnNode {
  std::string name;
  std::vector<unsigned> parts;
  NodePlace place;
};

/// The nodes that draw something, in the order of the tree, and where each named node is, which
/// lights and cameras look up.
std::vector<DrawnNode> drawn_nodes(const aiScene& in, const Mat34& world_from_file,
                                   NodePlaces& places, ExactPlaces& exact) {
  struct Visit {
    const aiNode* node;
    NodePlace parent;
  };
  std::vector<DrawnNode> drawn;
  std::vector<Visit> stack{{in.mRootNode, {world_from_file, as_stated(world_from_file)}}};
  while (!stack.empty()) {
    const auto [node, parent] = stack.back();
    stack.pop_back();
    const Mat34 local = mat34_of(node->mTransformation);
    const NodePlace place{parent.world * local, parent.exact * as_stated(local)};
    const Vec3 at = column(local, 3);
    if (at != Vec3{})
      exact.read_step_m =
          std::max(exact.read_step_m, std::cbrt(std::abs(double(determinant(parent.world)))) *
                                          float_step(double(max_component(max(at, -at)))));
    places.emplace(node->mName.C_Str(), place);
    for (unsigned i = node->mNumChildren; i-- > 0;) stack.push_back({node->mChildren[i], place});
    if (node->mNumMeshes == 0) continue;
    drawn.push_back(
        {node->mName.C_Str(), {node->mMeshes, node->mMeshes + node->mNumMeshes}, place});
  }
  return drawn;
}

/// Nodes that draw the same parts share one mesh.
void add_instances(const aiScene& in, const std::vector<DrawnNode>& drawn, const Habits& habits,
                   DVec3 near, scene::Scene& out, ExactPlaces& exact) {
  std::map<std::vector<unsigned>, uint32_t> known;
  for (const DrawnNode& node : drawn) {
    const auto [mesh, is_new] = known.try_emplace(node.parts, uint32_t(out.meshes.size()));
    if (is_new) {
      out.meshes.push_back(merged_mesh(in, node.parts, habits, out));
      out.meshes.back().name = node.name;
    }
    out.instances.push_back({node.name, mesh->second, node.place.world});
    exact.instances.push_back(node.place.exact * moved_by(near));
  }
}

/// True where an Assimp reader serves the ending of `path`. A reader names several endings, such as
/// "mesh mesh.xml".
bool is_for(const aiImporterDesc& reader, const std::string& path) {
  std::string_view endings = reader.mFileExtensions;
  for (std::string_view one = next_word(endings); !one.empty(); one = next_word(endings))
    if (lower_case(path).ends_with(fmt::format(".{}", one))) return true;
  return false;
}

/// Leaves Assimp only the readers for the file's ending. It would ask all others whether the
/// content is theirs when these refuse it, and they trust what they find.
void keep_readers(Assimp::Importer& importer, const std::string& path) {
  for (size_t i = importer.GetImporterCount(); i-- > 0;) {
    if (is_for(*importer.GetImporterInfo(i), path)) continue;
    Assimp::BaseImporter* reader = importer.GetImporter(i);
    importer.UnregisterLoader(reader);
    delete reader;
  }
}

/// Assimp's reader, its checks, and triangles alone: points and lines are sorted out.
Result<const aiScene*> read_file_with(Assimp::Importer& importer, const SourceFile& source,
                                      std::vector<std::string>& warnings) {
  // The scene is the importer's and not constant; Assimp says so only for its users' sake.
  const auto own = [&] { return const_cast<aiScene*>(importer.GetScene()); };
  const std::string path = path_for_assimp(source);
  constexpr unsigned kCheck = aiProcess_ValidateDataStructure;
  if (importer.ReadFile(path, kCheck) == nullptr && source.extension == ".fbx" &&
      is_about_names(importer.GetErrorString()) && importer.ReadFile(path, 0) != nullptr) {
    make_names_unique(*own(), warnings);
    importer.ApplyPostProcessing(kCheck);
  }
  if (own() == nullptr) return nullptr;
  LUXEL_TRY_STATUS(split_polygons(*own(), source, warnings));
  return importer.ApplyPostProcessing(aiProcess_SortByPType);
}

/// Text that Assimp gets in the place of a file that its reader could misread.
struct Rewritten {
  std::optional<std::string> text;
  DVec3 near = {};                  ///< what vertices are relative to
  bool has_display_colors = false;  ///< PlainPly's
};

/// Checks a file by its own rules, and writes it anew where Assimp needs that.
Result<Rewritten> rewrite(const SourceFile& source, std::vector<std::string>& warnings) {
  Rewritten out;
  if (source.extension == ".ply") {
    LUXEL_TRY(PlainPly plain, write_plain_ply(source, warnings));
    out = {std::move(plain.text), plain.near, plain.has_display_colors};
  } else if (source.extension == ".x") {
    LUXEL_TRY(out.text, write_plain_x(source, out.near));
  } else if (source.extension == ".dae") {
    LUXEL_TRY_STATUS(check_nesting(source));
    LUXEL_TRY_STATUS(check_collada(source));
    LUXEL_TRY(out.text, write_plain_collada(source, out.near));
  } else if (source.extension == ".stl") {
    LUXEL_TRY(out.text, write_near_stl(source, out.near));
  } else if (source.extension == ".fbx") {
    LUXEL_TRY_STATUS(check_fbx(source));
  }
  return out;
}

}  // namespace

std::string name_in_assimp(const std::filesystem::path& path) {
  const Assimp::Importer importer;
  for (size_t i = 0; i < importer.GetImporterCount(); ++i) {
    const aiImporterDesc& reader = *importer.GetImporterInfo(i);
    if (!is_for(reader, path.string())) continue;
    // "Blender 3D Importer (http://www.blender3d.org)"
    const std::string name = reader.mName;
    return name.substr(0, std::min(name.find(" Importer"), name.find(" Reader")));
  }
  return {};
}

Result<Imported> read_with_assimp(const SourceFile& source, ExactPlaces& exact) {
  Imported imported;
  LUXEL_TRY(Rewritten rewritten, rewrite(source, imported.warnings));
  Assimp::Importer importer;
  keep_readers(importer, path_for_assimp(source));
  importer.SetIOHandler(new FilesForAssimp(source, std::move(rewritten.text)));  // deletes it
  // Points and lines are sorted out into meshes of their own and dropped.
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  LUXEL_TRY(const aiScene* in, read_file_with(importer, source, imported.warnings));
  if (in == nullptr || in->mRootNode == nullptr) {
    // Memory that has ended is told from other errors by its type alone.
    if (const std::exception_ptr& thrown = importer.GetException()) std::rethrow_exception(thrown);
    return fail(ErrorCode::bad_input, "{}: cannot be read: {}", source.name,
                one_sentence(importer.GetErrorString()));
  }

  LUXEL_TRY_STATUS(read_assimp_materials(*in, source, imported));
  NodePlaces places;
  const std::vector<DrawnNode> drawn =
      drawn_nodes(*in, world_from_file(*in, source, imported.warnings), places, exact);
  const Habits habits{rewritten.has_display_colors, source.extension == ".stl"};
  add_instances(*in, drawn, habits, rewritten.near, imported.scene, exact);
  exact.is_relative = rewritten.near != DVec3{};
  add_assimp_lights(*in, source, places, imported, exact);
  add_assimp_cameras(*in, source, places, imported.scene, exact);
  if (source.extension == ".ply" || source.extension == ".stl")
    imported.about_lost_lights = fmt::format("{} files cannot hold lights", source.extension);
  return imported;
}

}  // namespace luxel::import
