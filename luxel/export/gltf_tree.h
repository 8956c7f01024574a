// The nodes of a glTF document, some of which are to stand elsewhere. For edited_gltf.cpp.
#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <vector>

#include "luxel/base/vec.h"

namespace luxel::export_ {

/// JSON whose members stay in their order.
using OrderedJson = nlohmann::ordered_json;

struct GltfTree {
  OrderedJson& document;
  std::vector<size_t> parent;                ///< of each node; kNoParent: it is a root
  std::vector<Eigen::Affine3d> was, wanted;  ///< world from node
};
inline constexpr size_t kNoParent = SIZE_MAX;

/// Errors by exceptions: indices out of range, circles.
GltfTree tree_of(OrderedJson& document);
Eigen::Affine3d affine(const Mat34& m);

/// A node below another, before its children, where that one was. Returns its number.
size_t add_child(GltfTree& tree, size_t parent, OrderedJson node);
/// A node among the roots of the file's scene.
size_t add_root(GltfTree& tree, OrderedJson node);

/// Brings all nodes to where they are wanted: those whose place, or whose parent's, has changed.
void write_places(GltfTree& tree);

/// The node's own part by this key, as "mesh"; the light by its extension.
inline constexpr const char* kLights = "KHR_lights_punctual";
bool has_light(const OrderedJson& node);
/// Takes an extension of a part of the document away.
void drop_extension(OrderedJson& part, const char* name);

}  // namespace luxel::export_
