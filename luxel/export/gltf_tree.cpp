#include "luxel/export/gltf_tree.h"

#include <set>
#include <stdexcept>

namespace luxel::export_ {
namespace {

Eigen::Affine3d local_of(const OrderedJson& node) {
  Eigen::Affine3d out = Eigen::Affine3d::Identity();
  if (node.contains("matrix")) {
    const auto m = node["matrix"].get<std::array<double, 16>>();
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 3; ++i) out(i, j) = m[size_t(4 * j + i)];
    return out;
  }
  const auto t = node.value("translation", std::array<double, 3>{0, 0, 0});
  const auto q = node.value("rotation", std::array<double, 4>{0, 0, 0, 1});
  const auto s = node.value("scale", std::array<double, 3>{1, 1, 1});
  out.translate(Eigen::Vector3d(t[0], t[1], t[2]));
  Eigen::Quaterniond turn(q[3], q[0], q[1], q[2]);
  if (turn.norm() > 0) out.rotate(turn.normalized());
  return out.scale(Eigen::Vector3d(s[0], s[1], s[2]));
}

/// Nodes that animations move: they may have no matrix.
std::set<size_t> animated_nodes(const OrderedJson& document) {
  std::set<size_t> out;
  if (!document.contains("animations")) return out;
  for (const OrderedJson& animation : document["animations"])
    for (const OrderedJson& channel : animation.at("channels"))
      if (channel.at("target").contains("node"))
        out.insert(channel["target"]["node"].get<size_t>());
  return out;
}

OrderedJson list_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

void write_local(const Eigen::Affine3d& local, bool is_animated, OrderedJson& node) {
  for (const char* key : {"matrix", "translation", "rotation", "scale"}) node.erase(key);
  const bool only_moves = local.linear().isIdentity(0);
  if (only_moves || is_animated) node["translation"] = list_of(local.translation());
  if (only_moves) return;
  if (is_animated) {
    Eigen::Matrix3d turn, scale;
    local.computeRotationScaling(&turn, &scale);
    const Eigen::Quaterniond q(turn);
    node["rotation"] = {q.x(), q.y(), q.z(), q.w()};
    node["scale"] = list_of(scale.diagonal());
    return;
  }
  OrderedJson matrix = OrderedJson::array();
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 3; ++i) matrix.push_back(local(i, j));
    matrix.push_back(j == 3 ? 1 : 0);
  }
  node["matrix"] = std::move(matrix);
}

OrderedJson& nodes_of(GltfTree& tree) { return tree.document.at("nodes"); }

bool stays(const GltfTree& tree, size_t node) {
  return node == kNoParent || tree.wanted[node].matrix() == tree.was[node].matrix();
}

}  // namespace

Eigen::Affine3d affine(const Mat34& m) {
  Eigen::Affine3d out = Eigen::Affine3d::Identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) out(i, j) = double(m.row[size_t(i)][size_t(j)]);
  return out;
}

GltfTree tree_of(OrderedJson& document) {
  if (!document.contains("nodes")) document["nodes"] = OrderedJson::array();
  OrderedJson& nodes = document["nodes"];
  GltfTree out{document, std::vector<size_t>(nodes.size(), kNoParent), {}, {}};
  out.was.resize(nodes.size());
  for (size_t n = 0; n < nodes.size(); ++n)
    if (nodes[n].contains("children"))
      for (const OrderedJson& child : nodes[n]["children"]) out.parent.at(child.get<size_t>()) = n;
  std::vector<size_t> order;
  for (size_t n = 0; n < nodes.size(); ++n)
    if (out.parent[n] == kNoParent) order.push_back(n);
  for (size_t k = 0; k < order.size(); ++k) {
    const size_t n = order[k], parent = out.parent[n];
    const Eigen::Affine3d local = local_of(nodes[n]);
    out.was[n] = parent == kNoParent ? local : out.was[parent] * local;
    if (nodes[n].contains("children"))
      for (const OrderedJson& child : nodes[n]["children"]) order.push_back(child.get<size_t>());
  }
  if (order.size() != nodes.size()) throw std::runtime_error("its nodes do not form trees");
  out.wanted = out.was;
  return out;
}

size_t add_child(GltfTree& tree, size_t parent, OrderedJson node) {
  OrderedJson& nodes = nodes_of(tree);
  const size_t number = nodes.size();
  nodes.push_back(std::move(node));
  tree.parent.push_back(parent);
  tree.was.push_back(tree.was[parent]), tree.wanted.push_back(tree.was[parent]);
  OrderedJson children = OrderedJson::array({number});
  if (nodes[parent].contains("children"))
    for (const OrderedJson& child : nodes[parent]["children"]) children.push_back(child);
  nodes[parent]["children"] = std::move(children);
  return number;
}

size_t add_root(GltfTree& tree, OrderedJson node) {
  OrderedJson& nodes = nodes_of(tree);
  const size_t number = nodes.size();
  nodes.push_back(std::move(node));
  tree.parent.push_back(kNoParent);
  tree.was.push_back(Eigen::Affine3d::Identity());
  tree.wanted.push_back(Eigen::Affine3d::Identity());
  OrderedJson& document = tree.document;
  if (!document.contains("scenes") || document["scenes"].empty()) return number;
  OrderedJson& scene = document["scenes"].at(document.value("scene", size_t(0)));
  if (!scene.contains("nodes")) scene["nodes"] = OrderedJson::array();
  scene["nodes"].push_back(number);
  return number;
}

void write_places(GltfTree& tree) {
  OrderedJson& nodes = nodes_of(tree);
  const std::set<size_t> animated = animated_nodes(tree.document);
  for (size_t n = 0; n < nodes.size(); ++n) {
    const size_t parent = tree.parent[n];
    if (stays(tree, n) && stays(tree, parent)) continue;
    const Eigen::Affine3d local =
        parent == kNoParent ? tree.wanted[n] : tree.wanted[parent].inverse() * tree.wanted[n];
    write_local(local, animated.contains(n), nodes[n]);
  }
}

bool has_light(const OrderedJson& node) {
  return node.contains("extensions") && node["extensions"].contains(kLights);
}

void drop_extension(OrderedJson& part, const char* name) {
  part["extensions"].erase(name);
  if (part["extensions"].empty()) part.erase("extensions");
}

}  // namespace luxel::export_
