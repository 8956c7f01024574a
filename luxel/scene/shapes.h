// Pieces that the procedural scenes are made of.
#pragma once

#include <array>
#include <string>
#include <utility>

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// Corners counter-clockwise seen from the front.
using Quad = std::array<Vec3, 4>;

/// The index of the vertex of `mesh` at exactly this position, added when there is none yet. Linear
/// search: for shapes of a few hundred vertices.
uint32_t vertex_at(Mesh& mesh, Vec3 position);
/// Corners counter-clockwise seen from the front; vertices are shared (vertex_at).
void add_triangle(Mesh& mesh, Vec3 a, Vec3 b, Vec3 c, uint32_t material);
/// Two triangles that meet in the diagonal from corner 0 to corner 2; a quad whose corners do not
/// lie in one plane is bent there.
void add_quad(Mesh& mesh, const Quad& quad, uint32_t material);
/// The quad without `hole`, as eight triangles. Corner i of the hole lies next to corner i of the
/// quad, so that both run the same way round.
void add_quad_with_hole(Mesh& mesh, const Quad& quad, const Quad& hole, uint32_t material);
/// The six faces of an axis-aligned box, seen from outside, corners shared.
void add_box(Mesh& mesh, Vec3 lower, Vec3 upper, uint32_t material);
/// A sphere around the origin with smooth normals: one vertex at each pole (index 0 on top, the
/// last one below), stacks - 1 rings of `slices` vertices between them; 2 slices (stacks - 1)
/// triangles.
Mesh sphere(std::string name, float radius_m, int slices, int stacks, uint32_t material);

/// Adds the mesh with one instance of the same name.
void place(Scene& scene, Mesh mesh, const Mat34& world_from_object = {});
/// A mesh of one horizontal rectangle, {x0, x1, z0, z1}, with its front up or down.
void add_rectangle(Scene& scene, const std::array<float, 4>& sides, float y, bool up,
                   uint32_t material);
/// Adds a diffuse material: reflectance 0..1, emitted radiance [W/(sr m^2)]. Returns its index.
uint32_t add_material(Scene& scene, std::string name, Rgb reflectance, Rgb emission = {});

/// A camera's pose: at `eye`, `target` in the middle of its picture, `up` upwards in it.
Mat34 look_at(Vec3 eye, Vec3 target, Vec3 up);

}  // namespace luxel::scene
