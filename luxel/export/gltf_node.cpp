#include "luxel/export/gltf_node.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>

#include "luxel/export/json_parts.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/scene/origin.h"

namespace luxel::export_ {
namespace {

using nlohmann::json;

Eigen::Matrix3d linear_part(const Mat34& m) {
  Eigen::Matrix3d out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = double(m.row[size_t(i)][size_t(j)]);
  return out;
}

/// True where translation * rotation * scale gives the matrix back, as the Khronos validator asks.
/// It allows an absolute error of 5e-5 in any entry, which a matrix of large scale misses by
/// rounding alone.
bool is_trs(const Eigen::Matrix3d& m) {
  const Eigen::Vector3d scale = m.colwise().norm();
  if (!(scale.minCoeff() > 1e-12)) return false;
  const Eigen::Matrix3d r = m * scale.cwiseInverse().asDiagonal();
  const double off = (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  return off * scale.maxCoeff() < 1e-5;
}

json quaternion(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(rotation).normalized();
  return {q.x(), q.y(), q.z(), q.w()};
}

json json_of(DVec3 p) { return {p.x, p.y, p.z}; }

/// A linear map is U S V^T: the inner node turns by V^T, the outer one scales by S and turns by U.
/// A mirror goes into the sign of a scale.
size_t append_sheared(Glb& glb, const Mat34& world, DVec3 place, json content) {
  // The matrix has dynamic size: for the fixed one gcc 12 sees an uninitialised value that is none.
  const Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::NoQRPreconditioner> svd(
      linear_part(world), Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU(), v = svd.matrixV();
  Eigen::Vector3d s = svd.singularValues();
  if (u.determinant() < 0) u.col(2) *= -1, s(2) *= -1;
  if (v.determinant() < 0) v.col(2) *= -1, s(2) *= -1;
  content["rotation"] = quaternion(v.transpose());
  const size_t inner = append(glb, "nodes", std::move(content));
  return append(glb, "nodes",
                {{"translation", json_of(place)},
                 {"rotation", quaternion(u)},
                 {"scale", {s(0), s(1), s(2)}},
                 {"children", {inner}}});
}

/// The rotation that brings -z, along which glTF's lights shine, to `direction`.
Mat34 facing(Vec3 direction, Vec3 position) {
  const Frame frame = frame_around(-normalize(direction));
  return from_columns(frame.tangent, frame.bitangent, frame.normal, position);
}

json light_json(const scene::PunctualLight& light) {
  const float largest = max_component(light.intensity);
  const Rgb color = largest > 0 ? light.intensity / largest : Rgb{1, 1, 1};
  json out = {{"color", {color.x, color.y, color.z}}, {"intensity", std::max(largest, 0.0f)}};
  if (!light.name.empty()) out["name"] = light.name;
  out["type"] = scene::name_of(light.kind);
  if (scene::has_position(light.kind) && light.range_m > 0) out["range"] = light.range_m;
  if (scene::has_cone(light.kind)) {
    // glTF wants 0 <= inner < outer <= pi / 2.
    const float outer = std::clamp(light.outer_cone_rad, 1e-4f, kPi / 2);
    out["spot"] = {{"innerConeAngle", std::clamp(light.inner_cone_rad, 0.0f, outer * 0.9999f)},
                   {"outerConeAngle", std::min(double(outer), 1.5707963267948966)}};
  }
  if (scene::has_disc(light))
    object_in(out, {"extras", "luxel"})["angular_radius_rad"] = light.angular_radius_rad;
  return out;
}

}  // namespace

size_t append_node(Glb& glb, const Mat34& world, json content) {
  const DVec3 place = scene::in_world(glb.origin, column(world, 3));
  if (world == translation(column(world, 3))) {
    if (place != DVec3{}) content["translation"] = json_of(place);
    return append(glb, "nodes", std::move(content));
  }
  if (!is_trs(linear_part(world))) return append_sheared(glb, world, place, std::move(content));
  json matrix = json::array();
  for (size_t j = 0; j < 3; ++j) {
    for (size_t i = 0; i < 3; ++i) matrix.push_back(world.row[i][j]);
    matrix.push_back(0.0);
  }
  for (const double v : {place.x, place.y, place.z, 1.0}) matrix.push_back(v);
  content["matrix"] = std::move(matrix);
  return append(glb, "nodes", std::move(content));
}

size_t append_light(Glb& glb, const scene::PunctualLight& light) {
  // Scenes have rows of equal lights, and some have a million: one entry for each row.
  json& list = array_in(object_in(glb.json, {"extensions", "KHR_lights_punctual"}), "lights");
  if (json entry = light_json(light); list.empty() || list.back() != entry)
    list.push_back(std::move(entry));
  glb.extensions_used.insert("KHR_lights_punctual");
  json node = {{"extensions", {{"KHR_lights_punctual", {{"light", list.size() - 1}}}}}};
  if (!light.name.empty()) node["name"] = light.name;
  const Vec3 direction = scene::has_direction(light.kind) ? light.direction : Vec3{0, 0, -1};
  return append_node(glb, facing(direction, light.position), std::move(node));
}

size_t append_camera(Glb& glb, const scene::Camera& camera, float near_m, float far_m) {
  json out = json::object();
  if (!camera.name.empty()) out["name"] = camera.name;
  if (camera.orthographic_height_m > 0) {
    const float half = 0.5f * camera.orthographic_height_m;
    out["type"] = "orthographic";
    out["orthographic"] = {{"xmag", half * (camera.aspect > 0 ? camera.aspect : 1.0f)},
                           {"ymag", half},
                           {"znear", near_m},
                           {"zfar", far_m}};
  } else {
    out["type"] = "perspective";
    out["perspective"] = {{"yfov", camera.fov_y_rad}, {"znear", near_m}, {"zfar", far_m}};
    if (camera.aspect > 0) out["perspective"]["aspectRatio"] = camera.aspect;
  }
  json node = {{"camera", append(glb, "cameras", std::move(out))}};
  if (!camera.name.empty()) node["name"] = camera.name;
  return append_node(glb, camera.world_from_camera, std::move(node));
}

}  // namespace luxel::export_
