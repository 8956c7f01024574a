// The parts of the Assimp reader. For its own files only.
#pragma once

#include <assimp/scene.h>

#include <map>

#include "luxel/import/readers.h"

namespace luxel::import {

/// Fills scene.materials, in Assimp's order, and the textures they use. Errors: a texture that is
/// missing or corrupt.
Status read_assimp_materials(const aiScene& in, const SourceFile& source, Imported& out);

inline Vec3 vec3_of(const aiVector3D& v) { return {v.x, v.y, v.z}; }
inline Mat34 mat34_of(const aiMatrix4x4& m) {
  return {{{{m.a1, m.a2, m.a3, m.a4}, {m.b1, m.b2, m.b3, m.b4}, {m.c1, m.c2, m.c3, m.c4}}}};
}

/// Makes triangles of all polygons (polygon.h), and warns of those that cross themselves. Errors: a
/// polygon of too many corners; memory.
Status split_polygons(aiScene& scene, const SourceFile& source, std::vector<std::string>& warnings);

/// Turns the file's units and axes into metres with Y up, above Assimp's own root node. Warns when
/// the file states nonsense.
Mat34 world_from_file(const aiScene& in, const SourceFile& source,
                      std::vector<std::string>& warnings);

/// Where a node is in the world, in both precisions.
struct NodePlace {
  Mat34 world;
  DMat34 exact;
};
/// The places of named nodes.
using NodePlaces = std::map<std::string, NodePlace>;

void add_assimp_lights(const aiScene& in, const SourceFile& source, const NodePlaces& places,
                       Imported& out, ExactPlaces& exact);
void add_assimp_cameras(const aiScene& in, const SourceFile& source, const NodePlaces& places,
                        scene::Scene& out, ExactPlaces& exact);

/// Is this error of Assimp's validation one that make_names_unique() can help?
bool is_about_names(std::string_view error);
/// Gives each light and camera of an .fbx, and its node, a name of its own. Warns of those that it
/// has to drop.
void make_names_unique(aiScene& scene, std::vector<std::string>& warnings);

struct ColladaLens {
  float fov_y_rad = 0;            ///< 0: not stated
  float orthographic_height = 0;  ///< in the file's unit; 0: perspective
  float aspect = 0;               ///< width / height; 0: that of the picture
};
/// One for each camera that a node of the .dae draws, in the order of the file.
std::vector<ColladaLens> read_collada_lenses(const SourceFile& source);

}  // namespace luxel::import
