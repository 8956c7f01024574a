// Techniques that draw surfaces in the workshop of local illumination and hemicube radiosity.
// [Rodriguez06]
#pragma once

#include <array>
#include <cstdint>

namespace luxel::view {

/// The first seven are those of display::LocalTechnique, in its order.
enum class Technique : uint32_t {
  c,
  ca,
  cad,
  cas,
  cads,
  cas_pixel,
  cads_pixel,
  normals,
  radiosity_vertex,  ///< B at the vertices, linear between [Rodriguez06, section 5.6]
  radiosity,         ///< E at the vertices, linear between; reflectance per pixel
  elements,          ///< the triangles of the hemicube solver's mesh, each in a colour
};

/// Its name in files that are played and for `luxel render --technique`, which has all but
/// radiosity-vertex and elements; the key that asks for it, and words for it. In the order of
/// Technique.
struct TechniqueName {
  const char *name, *key, *words;
};
inline constexpr std::array<TechniqueName, 11> kTechniques{{
    {"c", "1", "C: colour"},
    {"ca", "2", "CA: ambient"},
    {"cad", "3", "CAD: ambient, diffuse"},
    {"cas", "4", "CAS: ambient, specular"},
    {"cads", "5", "CADS: all three"},
    {"cas-pixel", "6", "CAS(P): CAS per pixel"},
    {"cads-pixel", "7", "CADS(P): CADS per pixel"},
    {"normals", "8", "normals"},
    {"radiosity-vertex", "9", "radiosity per vertex"},
    {"radiosity", "r", "radiosity per pixel"},
    {"elements", "t", "triangles in colours"},
}};

/// True: it shows light, which is exposed and shown over a curve. The others are colours that a
/// screen shows.
inline bool is_light(Technique t) {
  return t == Technique::radiosity_vertex || t == Technique::radiosity;
}
/// True: it needs the mesh of the hemicube solver.
inline bool needs_mesh(Technique t) { return t >= Technique::radiosity_vertex; }

}  // namespace luxel::view
