// Where morph targets and skins put the vertices of a glTF mesh: the file's own pose, without its
// animations. [glTF 2.0, sections 3.7.2.2 and 3.7.3]
#pragma once

#include <map>
#include <string>
#include <vector>

#include "luxel/import/gltf_accessor.h"
#include "luxel/import/gltf_parts.h"

namespace luxel::import {

using Attributes = std::map<std::string, int>;

/// The vertices of one primitive; arrays are empty or as long as positions.
struct Vertices {
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uv0, uv1;
  std::vector<Rgb> colors;
  std::vector<float> alphas;
  std::vector<bool> mirrored;  ///< triangles that begin here turn round; empty: none
};

/// A mesh as one node draws it.
struct Pose {
  std::vector<double> weights;  ///< of the morph targets; others have 0
  std::vector<Mat34> joints;    ///< world from mesh, of each joint of the skin; empty: no skin
  Mat34 world;                  ///< of the node; with a skin, where vertices of no joint go
};

/// True where a node's pose is another than that of its mesh alone.
bool has_own_pose(const tinygltf::Model& model, const tinygltf::Node& node);

/// The pose of a node that draws a mesh. Errors: too few inverse bind matrices.
Result<Pose> pose_of(const GltfReader& reader, size_t node);

/// An attribute of `count` rows; none when the primitive has none of this name. Errors: another
/// count, a type that is not one of `components`.
Result<Numbers> read_attribute(const GltfReader& reader, const Attributes& attributes,
                               const std::string& name, std::initializer_list<size_t> components,
                               size_t count, const std::string& where);

std::vector<Vec3> to_vec3(const Numbers& numbers);

/// Moves the vertices of a primitive to their place in the pose. Errors: attributes that do not
/// fit, a joint that the skin lacks.
Status apply_pose(const GltfReader& reader, const tinygltf::Primitive& primitive, const Pose& pose,
                  const std::string& where, Vertices& v);

}  // namespace luxel::import
