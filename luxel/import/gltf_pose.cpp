#include "luxel/import/gltf_pose.h"

#include <algorithm>

namespace luxel::import {
namespace {

/// Adds the targets' differences, each times its weight.
Status morph(const GltfReader& reader, const tinygltf::Primitive& primitive,
             const std::vector<double>& weights, const std::string& where, Vertices& v) {
  bool is_moved = false;
  for (size_t t = 0; t < std::min(weights.size(), primitive.targets.size()); ++t) {
    const auto weight = float(weights[t]);
    if (weight == 0) continue;
    is_moved = true;
    const auto add = [&](const char* name, std::vector<Vec3>& to) -> Status {
      if (to.empty()) return {};
      LUXEL_TRY(const Numbers numbers,
                read_attribute(reader, primitive.targets[t], name, {3}, to.size(),
                               where + fmt::format(", morph target {}", t)));
      const std::vector<Vec3> difference = to_vec3(numbers);
      for (size_t i = 0; i < difference.size(); ++i) to[i] += weight * difference[i];
      return {};
    };
    LUXEL_TRY_STATUS(add("POSITION", v.positions));
    LUXEL_TRY_STATUS(add("NORMAL", v.normals));
  }
  if (is_moved)
    for (Vec3& n : v.normals) n = normalize(n);
  return {};
}

/// The joints of one vertex and their weights, four in a set.
struct Influences {
  std::vector<Numbers> joints, weights;
};

Result<Influences> read_influences(const GltfReader& reader, const Attributes& attributes,
                                   size_t count, const std::string& where) {
  Influences out;
  for (int set = 0;; ++set) {
    const std::string joints = fmt::format("JOINTS_{}", set),
                      weights = fmt::format("WEIGHTS_{}", set);
    if (attributes.count(joints) != attributes.count(weights))
      return fail(ErrorCode::bad_input, "{} has only one of {} and {}", where, joints, weights);
    if (attributes.count(joints) == 0) return out;
    for (const auto& [name, list] : {std::pair{&joints, &out.joints}, {&weights, &out.weights}}) {
      LUXEL_TRY(Numbers numbers, read_attribute(reader, attributes, *name, {4}, count, where));
      list->push_back(std::move(numbers));
    }
  }
}

/// The weighted mean of the joints' maps at vertex i; the node's own where all weights are 0.
Result<Mat34> map_of(const Influences& influences, size_t i, const Pose& pose,
                     const std::string& where) {
  std::array<std::array<double, 4>, 3> sum{};
  double weights = 0;
  for (size_t k = 0; k < 4 * influences.joints.size(); ++k) {
    const double weight = double(influences.weights[k / 4].values[4 * i + k % 4]);
    // Exporters leave any number for a joint that has no weight.
    if (!(weight > 0)) continue;
    const double joint = double(influences.joints[k / 4].values[4 * i + k % 4]);
    if (!(joint >= 0 && joint < double(pose.joints.size())))
      return fail(ErrorCode::bad_input, "{}, JOINTS_{}: joint {} is out of range, the skin has {}",
                  where, k / 4, joint, pose.joints.size());
    const Mat34& map = pose.joints[size_t(joint)];
    for (size_t r = 0; r < 3; ++r)
      for (size_t c = 0; c < 4; ++c) sum[r][c] += weight * double(map.row[r][c]);
    weights += weight;
  }
  if (weights == 0) return pose.world;
  Mat34 out;
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 4; ++c) out.row[r][c] = float(sum[r][c] / weights);
  return out;
}

Status skin(const GltfReader& reader, const tinygltf::Primitive& primitive, const Pose& pose,
            const std::string& where, Vertices& v) {
  const size_t count = v.positions.size();
  LUXEL_TRY(const Influences influences,
            read_influences(reader, primitive.attributes, count, where));
  v.mirrored.resize(count);
  for (size_t i = 0; i < count; ++i) {
    LUXEL_TRY(const Mat34 map, map_of(influences, i, pose, where));
    v.positions[i] = transform_point(map, v.positions[i]);
    if (!v.normals.empty()) v.normals[i] = normalize(transform_normal(map, v.normals[i]));
    v.mirrored[i] = determinant(map) < 0;
  }
  return {};
}

}  // namespace

Result<Numbers> read_attribute(const GltfReader& reader, const Attributes& attributes,
                               const std::string& name, std::initializer_list<size_t> components,
                               size_t count, const std::string& where) {
  const auto found = attributes.find(name);
  if (found == attributes.end()) return Numbers{};
  const std::string what = where + ", " + name;
  // Before they are read: an accessor without a view may state any count.
  if (const size_t own = reader.model.accessors[size_t(found->second)].count; own != count)
    return fail(ErrorCode::bad_input, "{}: {} values for {} positions", what, own, count);
  return read_numbers(reader.model, found->second, components, what);
}

std::vector<Vec3> to_vec3(const Numbers& numbers) {
  std::vector<Vec3> values(numbers.count());
  for (size_t i = 0; i < values.size(); ++i) {
    const float* p = &numbers.values[i * numbers.components];
    values[i] = {p[0], p[1], p[2]};
  }
  return values;
}

bool has_own_pose(const tinygltf::Model& model, const tinygltf::Node& node) {
  return node.skin >= 0 ||
         (!node.weights.empty() && node.weights != model.meshes[size_t(node.mesh)].weights);
}

Result<Pose> pose_of(const GltfReader& reader, size_t number) {
  const tinygltf::Node& node = reader.model.nodes[number];
  const tinygltf::Mesh& mesh = reader.model.meshes[size_t(node.mesh)];
  Pose pose{node.weights.empty() ? mesh.weights : node.weights, {}, reader.world.rounded[number]};
  if (node.skin < 0) return pose;
  const tinygltf::Skin& skin = reader.model.skins[size_t(node.skin)];
  const std::string where = reader.source.name + ": " + label("skin", size_t(node.skin), skin.name);
  Numbers bind;
  if (skin.inverseBindMatrices >= 0) {
    LUXEL_TRY(bind, read_numbers(reader.model, skin.inverseBindMatrices, {16},
                                 where + ", inverseBindMatrices"));
    if (bind.count() < skin.joints.size())
      return fail(ErrorCode::bad_input, "{}: {} inverse bind matrices for {} joints", where,
                  bind.count(), skin.joints.size());
  }
  for (size_t k = 0; k < skin.joints.size(); ++k) {
    Mat34 from_mesh;
    for (size_t r = 0; r < 3 && bind.count() > 0; ++r)
      for (size_t c = 0; c < 4; ++c) from_mesh.row[r][c] = bind.values[16 * k + 4 * c + r];
    pose.joints.push_back(reader.world.rounded[size_t(skin.joints[k])] * from_mesh);
  }
  return pose;
}

Status apply_pose(const GltfReader& reader, const tinygltf::Primitive& primitive, const Pose& pose,
                  const std::string& where, Vertices& v) {
  LUXEL_TRY_STATUS(morph(reader, primitive, pose.weights, where, v));
  if (pose.joints.empty()) return {};
  return skin(reader, primitive, pose, where, v);
}

}  // namespace luxel::import
