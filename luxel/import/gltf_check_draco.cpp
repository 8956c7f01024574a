// KHR_draco_mesh_compression: what a compressed primitive may say.
#include "luxel/import/gltf_check_steps.h"

namespace luxel::import {
namespace {

constexpr char kName[] = "KHR_draco_mesh_compression";

Status check_draco_primitive(const Json& document, const Json& primitive,
                             const std::string& place) {
  LUXEL_TRY(const Json* extension, extension_of(primitive, kName, place));
  if (extension == nullptr) return {};
  const std::string where = place + ", " + kName;
  LUXEL_TRY_STATUS(whole_number(*extension, "bufferView", UINT64_MAX, where));
  LUXEL_TRY_STATUS(check_index(document, *extension, "bufferView", "bufferViews", where));
  const auto attributes = extension->find("attributes");
  if (attributes == extension->end() || !attributes->is_object())
    return fail(ErrorCode::bad_input, "{}: it has no attributes", where);
  for (const auto& item : attributes->items()) {
    if (!primitive["attributes"].contains(item.key()))
      return fail(ErrorCode::bad_input, "{}: {} is not among the primitive's attributes", where,
                  item.key());
    LUXEL_TRY(const uint64_t id, whole_number(*attributes, item.key().c_str(), UINT64_MAX, where));
    if (id > UINT32_MAX)
      return fail(ErrorCode::bad_input, "{}: {} has the id {}, which no attribute can have", where,
                  item.key(), id);
  }
  LUXEL_TRY(const uint64_t mode, whole_number(primitive, "mode", 4, place));
  if (mode != 4 && mode != 5)
    return fail(ErrorCode::bad_input, "{}: the mode is {}, must be 4 or 5 (triangles)", where,
                mode);
  return {};
}

}  // namespace

bool is_draco(const Json& primitive) {
  static const Json::json_pointer kExtension(fmt::format("/extensions/{}", kName));
  return primitive.contains(kExtension);
}

Status check_draco(const Json& document, const std::string& file) {
  return check_primitives(document, file, [&](const Json& primitive, const std::string& where) {
    return check_draco_primitive(document, primitive, where);
  });
}

}  // namespace luxel::import
