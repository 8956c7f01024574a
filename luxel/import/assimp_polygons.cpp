// Faces of more than three corners, which Assimp would split as fans, or wrongly where several
// notches meet.
#include <fmt/format.h>

#include "luxel/import/assimp_parts.h"
#include "luxel/import/polygon.h"

namespace luxel::import {
namespace {

/// A face with its indices, and an array of them, as Assimp allocates them.
constexpr uint64_t kFaceBytes = sizeof(aiFace) + 32;

/// Faces once all polygons are triangles: more than there are now if any has over three corners.
Result<size_t> count_faces(const aiMesh& mesh, size_t number, const SourceFile& source) {
  size_t out = 0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const unsigned corners = mesh.mFaces[f].mNumIndices;
    if (corners > kMostCorners)
      return fail(ErrorCode::bad_input, "{}: a face of {} has {} corners, more than {}; divide it",
                  source.name, label("mesh", number, mesh.mName.C_Str()), corners, kMostCorners);
    out += corners > 3 ? corners - 2 : 1;
  }
  return out;
}

void set_indices(aiFace& face, const unsigned* corners, const std::array<uint32_t, 3>& triangle) {
  face.mNumIndices = 3;
  face.mIndices = new unsigned[3];
  for (size_t k = 0; k < 3; ++k) face.mIndices[k] = corners[triangle[k]];
}

/// Gives `mesh` triangles for its polygons, in the order of its faces; `faces` are room enough.
/// Returns how many polygons cross themselves.
size_t split(aiMesh& mesh, size_t faces) {
  size_t crossing = 0;
  unsigned made = 0;
  std::unique_ptr<aiFace[]> out(new aiFace[faces]);
  std::vector<DVec3> corners;
  std::vector<std::array<uint32_t, 3>> triangles;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices <= 3) {
      std::swap(out[made].mNumIndices, face.mNumIndices);
      std::swap(out[made++].mIndices, face.mIndices);
      continue;
    }
    corners.clear(), triangles.clear();
    for (unsigned k = 0; k < face.mNumIndices; ++k)
      corners.push_back(to_double(vec3_of(mesh.mVertices[face.mIndices[k]])));
    crossing += triangulate(corners, triangles) ? 0 : 1;
    for (const auto& triangle : triangles) set_indices(out[made++], face.mIndices, triangle);
  }
  delete[] mesh.mFaces;
  mesh.mFaces = out.release(), mesh.mNumFaces = made;
  mesh.mPrimitiveTypes &= ~unsigned(aiPrimitiveType_POLYGON);
  mesh.mPrimitiveTypes |= aiPrimitiveType_TRIANGLE;
  return crossing;
}

}  // namespace

Status split_polygons(aiScene& scene, const SourceFile& source,
                      std::vector<std::string>& warnings) {
  size_t crossing = 0;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    aiMesh& mesh = *scene.mMeshes[m];
    LUXEL_TRY(const size_t faces, count_faces(mesh, m, source));
    if (faces == mesh.mNumFaces) continue;
    LUXEL_TRY_STATUS(source.memory.take(kFaceBytes * faces, "the triangles of " + source.name));
    crossing += split(mesh, faces);
  }
  if (crossing > 0)
    warnings.push_back(fmt::format(
        "{}: polygons whose outline crosses itself: {}; their area is not right; mend them in your "
        "modeller",
        source.name, crossing));
  return {};
}

}  // namespace luxel::import
