// Units and axes of the files that Assimp reads. Assimp turns COLLADA's unit and up axis into its
// root node's transform, and leaves FBX's in the scene's metadata (its GlobalScale step would take
// shear and mirrors out of the nodes). The other formats state neither.
#include <assimp/scene.h>

#include <cmath>

#include "luxel/import/assimp_parts.h"

namespace luxel::import {
namespace {

/// Metres per unit of an .fbx, whose UnitScaleFactor is in centimetres.
float fbx_unit_m(const aiMetadata& facts, const SourceFile& source,
                 std::vector<std::string>& warnings) {
  double centimetres = 1;
  float single = 1;
  if (facts.Get("UnitScaleFactor", single)) centimetres = double(single);
  facts.Get("UnitScaleFactor", centimetres);
  if (std::isfinite(centimetres) && centimetres > 0) return float(centimetres * 0.01);
  warnings.push_back(fmt::format("{}: its UnitScaleFactor is {}; centimetres are assumed",
                                 source.name, centimetres));
  return 0.01f;
}

/// The file's axis that `name` states, with its sign; zero when it states none of 0, 1, 2.
Vec3 fbx_axis(const aiMetadata& facts, const std::string& name, int axis) {
  int sign = 1;
  facts.Get(name, axis);
  facts.Get(name + "Sign", sign);
  const float s = sign < 0 ? -1.0f : 1.0f;
  return {axis == 0 ? s : 0, axis == 1 ? s : 0, axis == 2 ? s : 0};
}

}  // namespace

Mat34 world_from_file(const aiScene& in, const SourceFile& source,
                      std::vector<std::string>& warnings) {
  if (source.extension != ".fbx" || in.mMetaData == nullptr) return source.world_from_file;
  const aiMetadata& facts = *in.mMetaData;
  const float unit = fbx_unit_m(facts, source, warnings);
  // The rows: what is right, up, and towards the viewer in the file become x, y and z. A file that
  // says that it is left-handed gets a mirror, which keeps the front sides (scene.h).
  Vec3 right = fbx_axis(facts, "CoordAxis", 0), up = fbx_axis(facts, "UpAxis", 1),
       front = fbx_axis(facts, "FrontAxis", 2);
  if (std::abs(dot(right, cross(up, front))) < 0.5f) {
    warnings.push_back(
        fmt::format("{}: its UpAxis, FrontAxis and CoordAxis are not three axes; Y is taken as up",
                    source.name));
    right = {1, 0, 0}, up = {0, 1, 0}, front = {0, 0, 1};
  }
  right = right * unit, up = up * unit, front = front * unit;
  return {
      {{{right.x, right.y, right.z, 0}, {up.x, up.y, up.z, 0}, {front.x, front.y, front.z, 0}}}};
}

}  // namespace luxel::import
