// The scene: plain data, parts refer to each other by index.
//
// Units: metres, radians, linear RGB with sRGB primaries. Y is up. UV as in glTF: v grows
// downwards. Triangles are counter-clockwise seen from their front side. An instance whose
// transform mirrors keeps its front side (as glTF asks), so its world triangles are wound the other
// way round: ask world_triangle() below, which returns corners that are counter-clockwise in the
// world.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/vec_double.h"
#include "luxel/scene/environment.h"
#include "luxel/scene/light_profile.h"

namespace luxel::scene {

inline constexpr uint32_t kNone = UINT32_MAX;

/// An 8-bit RGBA picture, display values (sRGB transfer function), row 0 is v = 0.
struct Texture {
  std::string name;
  int width = 0, height = 0;
  std::vector<uint8_t> rgba;       ///< 4 * width * height
  std::vector<std::byte> encoded;  ///< the PNG, JPEG or WebP file it came from; may be empty
  std::string mime_type;           ///< of `encoded`
};

/// The continuation of a texture beyond its edges, as in glTF.
enum class Wrap : uint8_t { repeat, clamp, mirror };
/// The look-up of a texture between its pixels.
enum class Filter : uint8_t { linear, nearest };

/// A material's look-up of a texture: uv' = offset + rotate(scale * uv)  [KHR_texture_transform].
struct TextureRef {
  uint32_t texture = kNone;
  int uv_set = 0;  ///< 0 = TEXCOORD_0, 1 = TEXCOORD_1
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  Filter filter = Filter::linear;
  Vec2 offset{0, 0}, scale{1, 1};
  float rotation = 0;  ///< radians, counter-clockwise in glTF's UV space as the extension defines
};

/// The meaning of alpha, as in glTF: nothing, holes below a limit, a share that is let through.
enum class AlphaMode : uint8_t { opaque, mask, blend };

/// A surface: what it reflects, emits and lets through. Factors are those of glTF 2.0.
struct Material {
  std::string name;
  Rgb base_color{1, 1, 1};
  float alpha = 1;
  float metallic = 0;
  float roughness = 1;
  TextureRef base_color_texture;  ///< multiplies base_color and alpha
  TextureRef metallic_texture;    ///< its blue channel, linear, multiplies metallic
  Rgb emission{0, 0, 0};          ///< radiance L [W/(sr m^2)]: emissiveFactor * strength
  TextureRef emission_texture;    ///< multiplies emission
  TextureRef normal_texture;      ///< bends the normal of pictures: luxel/scene/normal_map.h
  float normal_scale = 1;
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;  ///< mask: alpha below it is a hole
  float transmission = 0;     ///< KHR_materials_transmission: share that goes straight through
  TextureRef transmission_texture;  ///< its red channel, linear, multiplies transmission
  /// KHR_materials_diffuse_transmission: of the light that meets a thin surface and is not mirrored
  /// by metal this share is not reflected, but scattered through, tinted.
  float diffuse_transmission = 0;
  Rgb diffuse_transmission_color{1, 1, 1};
  TextureRef diffuse_transmission_texture;        ///< its alpha, multiplies the share
  TextureRef diffuse_transmission_color_texture;  ///< multiplies the colour
  bool double_sided = false;
  bool unlit = false;  ///< KHR_materials_unlit: shown in its base colour, however it is lit
  /// Phong's highlight, for luxel/display/local_light.h alone: global illumination here is diffuse.
  Rgb specular{0, 0, 0};  ///< C_s of [Rodriguez06, eq. 4.26]
  float sharpness = 20;   ///< its exponent n, >= 0
};

/// Everything that a material, constant or not, looks up.
template <class AnyMaterial>
auto textures_of(AnyMaterial& m) {
  return std::array{&m.base_color_texture,
                    &m.metallic_texture,
                    &m.emission_texture,
                    &m.normal_texture,
                    &m.transmission_texture,
                    &m.diffuse_transmission_texture,
                    &m.diffuse_transmission_color_texture};
}

/// Indexed triangles. Attribute arrays are either empty or as long as `positions`.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;  ///< object space
  std::vector<Vec3> normals;    ///< unit, object space; empty: flat shading
  std::vector<Vec2> uv0, uv1;   ///< TEXCOORD_0, TEXCOORD_1
  std::vector<Rgb> colors;      ///< linear, multiplies the base colour
  std::vector<float> alphas;    ///< multiplies alpha
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint32_t> triangle_material;  ///< per triangle, index into Scene::materials
  /// Thin surfaces whose two sides each have light of their own: the number of the triangle that is
  /// this one's other side, (a, c, b) for (a, b, c); kNone where there is none, empty where no
  /// triangle has one (luxel/scene/sides.h). A ray meets the side that it comes from.
  std::vector<uint32_t> other_side;
};

/// A mesh placed in the world.
struct Instance {
  std::string name;
  uint32_t mesh = 0;
  Mat34 world_from_object;
  float texel_density = 1;  ///< texels per metre in a lightmap, over those of other instances
  /// False: viewers light it in another way. It keeps a few texels, for the light that it reflects.
  bool lightmapped = true;
};
/// Density of instances that are not lightmapped: an eighth is a 64th of the texels.
inline constexpr float kCoarseDensity = 0.125f;
/// Limits of Instance::texel_density.
inline constexpr float kMinTexelDensity = 1.0f / 64, kMaxTexelDensity = 64;
/// The density that an instance is laid out with.
inline float layout_density(const Instance& instance) {
  return instance.lightmapped ? instance.texel_density : kCoarseDensity;
}

/// A light without area.
struct PunctualLight {
  /// The way that it spreads its light, as in KHR_lights_punctual.
  enum class Kind : uint8_t { point, spot, directional };
  std::string name;
  Kind kind = Kind::point;
  /// I [W/sr] for point and spot, with a profile a factor on its candela; E on a facing surface
  /// [W/m^2] else.
  Rgb intensity{1, 1, 1};
  Vec3 position{};                 ///< point, spot
  Vec3 direction{0, -1, 0};        ///< spot, directional, profile: unit, the way the light travels
  float range_m = 0;               ///< 0 = no limit; else glTF's window function
  float inner_cone_rad = 0;        ///< spot: full light inside
  float outer_cone_rad = kPi / 4;  ///< spot: no light outside
  float angular_radius_rad = 0;    ///< directional: half the angle of the disc (sun 0.00465)
  uint32_t profile = kNone;  ///< point, spot: of Scene::profiles; kNone: even in all directions
  Vec3 side{1, 0, 0};        ///< where its horizontal angle 0 points: unit, at a right angle
                             ///< to `direction`
};

/// A view of the scene.
struct Camera {
  std::string name;
  Mat34 world_from_camera;  ///< looks along its -z, its y is up
  float fov_y_rad = 0.8f;   ///< perspective; ignored when orthographic_height_m > 0
  float aspect = 0;         ///< width / height; 0: that of the picture
  float orthographic_height_m = 0;
};

/// Everything that is lit and that shines. What solvers may rely on: luxel/scene/validate.h.
struct Scene {
  std::string name;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<PunctualLight> lights;
  std::vector<LightProfile> profiles;  ///< distributions of lights
  std::vector<Camera> cameras;
  Rgb background{0, 0, 0};  ///< radiance seen by rays that leave the scene
  Environment environment;  ///< what they see besides; empty: nothing
  /// The place in the world of the file that (0, 0, 0) of all coordinates here stands for [m]: not
  /// 0 for a scene far from its origin, which the reader has moved. Light does not depend on it.
  DVec3 origin{};
};

/// A point of a surface: which instance, which triangle of its mesh, where in it.
struct SurfacePoint {
  uint32_t instance = 0, triangle = 0;
  Barycentric at;
};

/// The corners of a triangle [m].
struct Triangle3 {
  Vec3 a, b, c;
};
/// The normal of a triangle, counter-clockwise, with twice its area as length [m^2].
inline Vec3 geometric_normal_area2(const Triangle3& t) { return cross(t.b - t.a, t.c - t.a); }
/// The area of a triangle [m^2].
inline float area_m2(const Triangle3& t) { return 0.5f * length(geometric_normal_area2(t)); }

/// World corners in the order of the mesh's indices (barycentrics stay valid). For a mirroring
/// instance this order is clockwise from the front: use front_normal for the side.
Triangle3 world_triangle(const Scene& scene, uint32_t instance, uint32_t triangle);
/// The unit geometric normal of the front side, in the world; zero for a degenerate triangle.
Vec3 front_normal(const Scene& scene, uint32_t instance, uint32_t triangle);
/// The interpolated unit shading normal in the world, on the side of front_normal; equals it when
/// the mesh has no normals.
Vec3 shading_normal(const Scene& scene, const SurfacePoint& p);
/// The place of a surface point in the world [m].
Vec3 world_position(const Scene& scene, const SurfacePoint& p);

/// The most that a surface reflects. One that reflected all light would keep it for ever: sums over
/// bounces would not end.
inline constexpr float kMaxReflectance = 0.99f;

/// The material of a surface point's triangle.
const Material& material_at(const Scene& scene, const SurfacePoint& p);
/// rho = base colour * (1 - metallic) * (1 - t), each channel in [0, 0.99]; t is the share that is
/// scattered through.
Rgb reflectance_at(const Scene& scene, const SurfacePoint& p);
/// tau = colour * (1 - metallic) * t of KHR_materials_diffuse_transmission: of the irradiance on
/// one side, what leaves the other side as diffuse light. rho + tau is at most 0.99.
Rgb diffuse_transmittance_at(const Scene& scene, const SurfacePoint& p);
/// Emitted radiance L [W/(sr m^2)] of the front side (of both when double-sided).
Rgb emission_at(const Scene& scene, const SurfacePoint& p);
/// False in the holes of an alpha mask.
bool is_solid_at(const Scene& scene, const SurfacePoint& p);

/// Light that goes straight through a surface: of what falls on a point the share 1 - coverage goes
/// on, in the colour `tint`; the rest meets an opaque surface with reflectance_at. A blended
/// material of opacity a and colour c covers a, and tints by 1 - a (1 - c), so that faint glass is
/// clear and dense glass coloured; a transmissive one of factor t covers 1 - t and tints by its
/// base colour, without Fresnel's loss. Holes of masks cover nothing.
struct Passage {
  float coverage = 1;
  Rgb tint{1, 1, 1};
};
/// The light that goes straight through the surface at a point, textures included.
Passage passage_at(const Scene& scene, const SurfacePoint& p);
/// True: light can go straight through some of a material, holes of masks included.
bool lets_light_through(const Material& material);
/// Light that goes through the material may come out coloured.
bool tints_light(const Material& material);
/// The back reflects light, too: of double-sided materials, and of those that light goes through.
/// Rays leave a pane of glass through the back of its far side, and a leaf glows on both sides.
bool reflects_from_behind(const Material& material);
/// Radiance that a ray sees which leaves the scene: background plus environment.
Rgb surroundings_towards(const Scene& scene, Vec3 direction);
/// Surroundings for pictures, in which the map's pixels are not to be seen.
Rgb smooth_surroundings_towards(const Scene& scene, Vec3 direction);
/// Where a material looks a texture up that has the texture coordinates uv.
Vec2 transformed_uv(const TextureRef& ref, Vec2 uv);
/// The texture's value at a surface point, bilinear, in linear light where it is sRGB; white when
/// there is no texture or the mesh has no coordinates for it.
std::array<float, 4> texture_at(const Scene& scene, const SurfacePoint& p, const TextureRef& ref,
                                bool srgb);

/// Texture colour times vertex colour times factor, linear, alpha in the fourth value.
std::array<float, 4> base_color_at(const Scene& scene, const SurfacePoint& p);

/// Number of triangles drawn, that is over all instances, and the offset of each instance in a
/// numbering of them: triangle t of instance i is number first[i] + t; first has one extra entry.
std::vector<uint32_t> first_triangles(const Scene& scene);
/// The smallest box around the vertices of all instances [m]; empty without any.
Box3 world_bounds(const Scene& scene);

}  // namespace luxel::scene
