// Everything a scene's indices point at must be there.
#include "luxel/scene/validate_steps.h"

namespace luxel::scene {
namespace {

Status check_arrays(const Mesh& mesh, const std::string& where) {
  const std::pair<const char*, size_t> arrays[] = {{"normals", mesh.normals.size()},
                                                   {"uv0", mesh.uv0.size()},
                                                   {"uv1", mesh.uv1.size()},
                                                   {"colors", mesh.colors.size()},
                                                   {"alphas", mesh.alphas.size()}};
  for (const auto& [name, size] : arrays)
    if (size != 0 && size != mesh.positions.size())
      return fail(ErrorCode::bad_input, "{} has {} {} for {} positions; must be none or as many",
                  where, size, name, mesh.positions.size());
  if (mesh.triangle_material.size() != mesh.triangles.size())
    return fail(ErrorCode::bad_input, "{} has {} material indices for {} triangles", where,
                mesh.triangle_material.size(), mesh.triangles.size());
  return {};
}

Status check_mesh(const Scene& scene, size_t index, const Report& report) {
  const Mesh& mesh = scene.meshes[index];
  const std::string where = report.file + ": " + label("mesh", index, mesh.name);
  LUXEL_TRY_STATUS(check_arrays(mesh, where));
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const uint32_t corner : mesh.triangles[t])
      if (corner >= mesh.positions.size())
        return fail(ErrorCode::bad_input,
                    "{}, triangle {}: vertex index {} is out of range, there "
                    "are {} vertices",
                    where, t, corner, mesh.positions.size());
    if (mesh.triangle_material[t] >= scene.materials.size())
      return fail(ErrorCode::bad_input,
                  "{}, triangle {}: material index {} is out of range, there "
                  "are {} materials",
                  where, t, mesh.triangle_material[t], scene.materials.size());
  }
  return {};
}

Status check_texture_ref(const Scene& scene, const TextureRef& ref, const std::string& where) {
  if (ref.texture == kNone) return {};
  if (ref.texture >= scene.textures.size())
    return fail(ErrorCode::bad_input, "{}: texture index {} is out of range, there are {} textures",
                where, ref.texture, scene.textures.size());
  if (ref.uv_set != 0 && ref.uv_set != 1)
    return fail(ErrorCode::bad_input, "{}: UV set {} is asked for; only 0 and 1 exist", where,
                ref.uv_set);
  return {};
}

}  // namespace

Status check_references(const Scene& scene, const Report& report) {
  // Meshes, instances and materials by index.
  for (size_t i = 0; i < scene.meshes.size(); ++i) LUXEL_TRY_STATUS(check_mesh(scene, i, report));
  for (size_t i = 0; i < scene.instances.size(); ++i)
    if (scene.instances[i].mesh >= scene.meshes.size())
      return fail(ErrorCode::bad_input,
                  "{}: {}: mesh index {} is out of range, there are {} meshes", report.file,
                  label("instance", i, scene.instances[i].name), scene.instances[i].mesh,
                  scene.meshes.size());
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    const std::string where = report.file + ": " + label("material", i, m.name);
    for (const TextureRef* ref : textures_of(m))
      LUXEL_TRY_STATUS(check_texture_ref(scene, *ref, where));
  }
  for (size_t i = 0; i < scene.lights.size(); ++i)
    if (scene.lights[i].profile != kNone && scene.lights[i].profile >= scene.profiles.size())
      return fail(ErrorCode::bad_input,
                  "{}: {}: profile index {} is out of range, there are {} profiles", report.file,
                  label("light", i, scene.lights[i].name), scene.lights[i].profile,
                  scene.profiles.size());
  // Textures have the bytes that their size needs.
  for (size_t i = 0; i < scene.textures.size(); ++i) {
    const Texture& t = scene.textures[i];
    if (t.width < 1 || t.height < 1 ||
        t.rgba.size() != size_t(4) * size_t(t.width) * size_t(t.height))
      return fail(ErrorCode::bad_input, "{}: {}: {} bytes for {} x {} RGBA pixels", report.file,
                  label("texture", i, t.name), t.rgba.size(), t.width, t.height);
  }
  return {};
}

}  // namespace luxel::scene
