// How a baked surface looks: rho E / pi + emission, exposed, through the curve of preview.png.
import * as THREE from "three";

/** luxel/display/tone_map.cpp's compress(), and the sRGB transfer function of luxel/image/color.h. */
const toneMap = /* glsl */ `
float shoulder(float x) {
  const float a = 0.5;
  if (x <= a) return x;
  float t = (x - a) / (1.0 - a);
  return a + (1.0 - a) * (1.0 - 1.0 / (1.0 + t));
}
vec3 compress(vec3 exposed) {
  vec3 c = clamp(exposed, 0.0, 1e18);
  float m = max(max(c.r, c.g), c.b);
  if (!(m > 0.0)) return vec3(0.0);
  float f = shoulder(m), kept = 1.0 / (1.0 + 0.15 * max(0.0, m - 1.0));
  return f + (c * (f / m) - f) * kept;
}
vec3 srgb(vec3 c) {
  return mix(1.055 * pow(max(c, 1e-9), vec3(1.0 / 2.4)) - 0.055, 12.92 * c,
             vec3(lessThanEqual(c, vec3(0.0031308))));
}`;

/**
 * luxel/display/smooth_lookup.h: 16 weights of texels, from `first` on. Alpha is 1 inside of charts,
 * at least 1/2 where there is a surface, and less in the gutter, which counts where nothing else is.
 */
const smoothLight = /* glsl */ `
#ifdef LAYERS
#define TEXEL(texel, layer) texelFetch(light, ivec3(texel, layer), 0)
#define BILINEAR(place, layer) texture(light, vec3(place, float(layer)))
#else
#define TEXEL(texel, layer) texelFetch(light, texel, 0)
#define BILINEAR(place, layer) texture(light, place)
#endif
float spline(float away) {
  float d = abs(away);
  return d < 0.5 ? 0.75 - d * d : 0.5 * max(1.5 - d, 0.0) * max(1.5 - d, 0.0);
}
float bilinear(vec2 away) {
  return max(1.0 - abs(away.x), 0.0) * max(1.0 - abs(away.y), 0.0);
}
struct Smooth {
  ivec2 first;
  float weight[16];  // all 0: in the gutter
};
Smooth smoothAt(vec2 place) {
  Smooth s;
  ivec2 size = textureSize(light, 0).xy;
  vec2 at = place * vec2(size) - 0.5;
  vec2 to = at - floor(at) + 1.0;
  s.first = ivec2(floor(at)) - 1;
  uint inside = 0u;  // bit 4 y + x: a texel of the 4 x 4 is
  float linear[16];
  vec2 sums = vec2(0.0);
  for (int k = 0; k < 16; ++k) {
    ivec2 cell = ivec2(k & 3, k >> 2), texel = s.first + cell;
    bool isThere = all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(texel, size));
    float alpha = isThere ? TEXEL(texel, 0).a : 0.0;
    vec2 away = to - vec2(cell);
    linear[k] = alpha < 0.5 ? 0.0 : bilinear(away);
    s.weight[k] = alpha < 1.0 ? 0.0 : spline(away.x) * spline(away.y);
    if (alpha >= 1.0) inside |= 1u << k;
    sums += vec2(linear[k], s.weight[k]);
  }
  float share = 0.0;
  for (int k = 0; k < 4; ++k) {
    ivec2 cell = ivec2(k & 1, k >> 1);
    uint around = 0x777u << (cell.x + 4 * cell.y);
    if ((inside & around) == around) share += bilinear(to - 1.0 - vec2(cell));
  }
  sums = max(sums, 1e-9);
  for (int k = 0; k < 16; ++k)
    s.weight[k] = mix(linear[k] / sums.x, s.weight[k] / sums.y, share);
  return s;
}
vec3 lightAt(vec2 place, int layer, Smooth s) {
  vec4 sum = vec4(0.0);
  for (int k = 0; k < 16; ++k)
    if (s.weight[k] > 0.0)
      sum += vec4(TEXEL(s.first + ivec2(k & 3, k >> 2), layer).rgb, 1.0) * s.weight[k];
  return sum.a > 0.5 ? sum.rgb : BILINEAR(place, layer).rgb;
}`;

const vertexShader = /* glsl */ `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform mat3 mapTransform, metalTransform, emissionTransform;
in vec3 position;
in vec2 uv1;
#ifdef HAS_COLOR
in vec4 color;
#endif
#ifdef HAS_UV
in vec2 uv;
#endif
#ifdef HAS_UV2
in vec2 uv2;
#endif
centroid out vec2 atLight;
out vec2 atMap, atMetal, atEmission;
out vec3 tint;
out float clear;  // 1 - alpha: where all corners have 0, no rounding leaves a hole
void main() {
  atLight = uv1;
#ifdef MAP_UV
  atMap = (mapTransform * vec3(MAP_UV, 1.0)).xy;
#endif
#ifdef METAL_UV
  atMetal = (metalTransform * vec3(METAL_UV, 1.0)).xy;
#endif
#ifdef EMISSION_UV
  atEmission = (emissionTransform * vec3(EMISSION_UV, 1.0)).xy;
#endif
#ifdef HAS_COLOR
  tint = color.rgb;
  clear = 1.0 - color.a;
#else
  tint = vec3(1.0);
  clear = 0.0;
#endif
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const fragmentShader = /* glsl */ `
precision highp float;
precision highp sampler2DArray;
#ifdef LAYERS
uniform sampler2DArray light;
uniform float layerScale[LAYERS];
uniform vec3 layerColor[LAYERS];
#else
uniform sampler2D light;
uniform float lightScale;
#endif
uniform sampler2D map, metal, glow;
uniform vec3 baseColor, emission;
uniform float alpha, cutoff, metallic, exposure;
uniform int show;
// At pixels that a triangle covers in part, the middle can lie outside of it: far away in the atlas,
// on nothing, where the triangle is seen edge-on. The light map has no mipmaps that need it even.
centroid in vec2 atLight;
in vec2 atMap, atMetal, atEmission;
in vec3 tint;
in float clear;
out vec4 pixel;
${toneMap}
${smoothLight}
void main() {
  vec4 base = vec4(baseColor * tint, alpha * (1.0 - clear));
  float metalness = metallic;
  vec3 emitted = emission;
#ifdef MAP_UV
  base *= texture(map, atMap);
#endif
#ifdef METAL_UV
  metalness *= texture(metal, atMetal).b;
#endif
#ifdef EMISSION_UV
  emitted *= texture(glow, atEmission).rgb;
#endif
#ifdef SHINES_IN
  emitted *= layerColor[SHINES_IN];
#endif
  if (base.a < cutoff) discard;
  vec3 rho = clamp(base.rgb * (1.0 - clamp(metalness, 0.0, 1.0)), 0.0, 0.99);
  Smooth smoothly = smoothAt(atLight);
#ifdef LAYERS
  vec3 irradiance = vec3(0.0);
  for (int l = 0; l < LAYERS; ++l)
    irradiance += lightAt(atLight, l, smoothly) * (layerScale[l] * layerColor[l]);
#else
  vec3 irradiance = lightAt(atLight, 0, smoothly) * lightScale;
#endif
  const float pi = 3.14159265358979;
#ifdef UNLIT
  vec3 radiance = base.rgb;
#else
  vec3 radiance = rho * irradiance / pi + emitted;
#endif
  vec3 shown = show == 2 ? rho : show == 1 ? compress(exposure * irradiance / pi)
             : compress(exposure * radiance);
  pixel = vec4(srgb(shown), 1.0);
}`;

/** Whole-screen: what is seen where there is no surface. */
const backgroundVertexShader = /* glsl */ `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
in vec3 position;
out vec3 towards;
void main() {
  mat4 p = projectionMatrix;
  bool parallel = p[3][3] == 1.0;
  vec3 ahead = parallel ? vec3(0, 0, -1)
             : vec3((position.x + p[2][0]) / p[0][0], (position.y + p[2][1]) / p[1][1], -1);
  towards = transpose(mat3(modelViewMatrix)) * ahead;  // it stands unturned at the origin
  gl_Position = vec4(position, 1.0);
}`;

/** luxel/scene/environment.h has the map's shape. */
const backgroundShader = /* glsl */ `
precision highp float;
uniform vec3 background;
uniform float exposure;
uniform int show;
#ifdef SURROUNDINGS
uniform sampler2D surroundings;
uniform float surroundingsScale, rotation;
#endif
#ifdef SHINES_IN
uniform vec3 layerColor[LAYERS];
#endif
in vec3 towards;
out vec4 pixel;
${toneMap}
void main() {
  vec3 seen = background;
#ifndef SURROUNDINGS
  if (background == vec3(0.0)) {  // nothing is there: the grey of preview.png, at any exposure
    pixel = vec4(srgb(vec3(show == 2 ? 0.0 : 0.2)), 1.0);
    return;
  }
#endif
#ifdef SURROUNDINGS
  const float pi = 3.14159265358979;
  vec3 d = normalize(towards);
  vec2 at = vec2(0.5 + (atan(d.z, d.x) - rotation) / (2.0 * pi), atan(length(d.xz), d.y) / pi);
  seen += texture(surroundings, at).rgb * surroundingsScale;
#endif
#ifdef SHINES_IN
  seen *= layerColor[SHINES_IN];
#endif
  pixel = vec4(show == 2 ? vec3(0.0) : srgb(compress(exposure * seen)), 1.0);
}`;

const uvName = (channel) => (channel === 0 ? "uv" : `uv${channel}`);

/** Offset, rotation and scale as KHR_texture_transform orders them; three scales last. */
function textureTransform({ offset, rotation, repeat }) {
  const c = Math.cos(rotation), s = Math.sin(rotation);
  return new THREE.Matrix3(c * repeat.x, s * repeat.y, offset.x, -s * repeat.x, c * repeat.y, offset.y, 0, 0, 1);
}

/** A texture whose numbers are not colours. GLTFLoader has one object where colours share its picture. */
function linear(texture) {
  if (!texture || texture.colorSpace === THREE.NoColorSpace) return texture;
  const own = texture.clone();
  own.colorSpace = THREE.NoColorSpace;
  return own;
}

/**
 * The material of a mesh of baked.glb, from what GLTFLoader made of it. `common`: the uniforms that
 * all materials share (exposure, show; with layers their colours); `page`: those of its lightmap
 * (light and lightScale, or layerScale); `layer`: the number of the one that the surface shines in,
 * or -1.
 */
export function bakedMaterial(loaded, geometry, page, common, layer) {
  const lit = loaded.isMeshStandardMaterial === true;
  const defines = { ...layerDefines(common, layer) };
  if (!lit) defines.UNLIT = "";  // KHR_materials_unlit: GLTFLoader's MeshBasicMaterial
  const uniforms = {
    ...common,
    ...page,
    baseColor: { value: loaded.color },
    alpha: { value: loaded.opacity },
    cutoff: { value: loaded.alphaTest },
    metallic: { value: lit ? loaded.metalness : 0 },
    emission: { value: lit ? loaded.emissive.clone().multiplyScalar(loaded.emissiveIntensity) : new THREE.Color(0) },
  };
  const lookUp = (texture, name, sampler, transform) => {
    if (!texture || !geometry.hasAttribute(uvName(texture.channel))) return;
    defines[name] = uvName(texture.channel);
    uniforms[sampler] = { value: texture };
    uniforms[transform] = { value: textureTransform(texture) };
  };
  lookUp(loaded.map, "MAP_UV", "map", "mapTransform");
  if (lit) lookUp(linear(loaded.metalnessMap), "METAL_UV", "metal", "metalTransform");
  if (lit) lookUp(loaded.emissiveMap, "EMISSION_UV", "glow", "emissionTransform");
  if (geometry.hasAttribute("uv")) defines.HAS_UV = "";
  if (geometry.hasAttribute("uv2")) defines.HAS_UV2 = "";
  if (geometry.hasAttribute("color")) defines.HAS_COLOR = "";
  return new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3, defines, uniforms, vertexShader, fragmentShader, side: loaded.side,
  });
}

/** What both shaders are told of layers: how many there are, and which one's colour is their own. */
function layerDefines({ layerColor }, layer) {
  if (!layerColor) return {};
  return { LAYERS: layerColor.value.length, ...(layer >= 0 && { SHINES_IN: layer }) };
}

/**
 * `surroundings`: the map behind the background's radiance and how it is turned, or null; `layer`:
 * the number of the one that they are, or -1.
 */
export function backgroundMesh(background, surroundings, common, layer) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute([-1, -1, 0, 3, -1, 0, -1, 3, 0], 3));
  const mesh = new THREE.Mesh(geometry, new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3,
    defines: { ...(surroundings && { SURROUNDINGS: "" }), ...layerDefines(common, layer) },
    uniforms: {
      ...common,
      background: { value: new THREE.Vector3(...background) },
      surroundings: { value: surroundings?.texture ?? null },
      surroundingsScale: { value: surroundings?.scale ?? 1 },
      rotation: { value: surroundings?.rotation ?? 0 },
    },
    vertexShader: backgroundVertexShader,
    fragmentShader: backgroundShader,
    depthTest: false, depthWrite: false,
  }));
  mesh.frustumCulled = false;
  mesh.raycast = () => {};
  mesh.renderOrder = -1;
  return mesh;
}

/**
 * Halves, looked up bilinearly, clamped, or around the vertical. They are filtered by the graphics
 * card itself.
 */
export function halfTexture(halves, { width, height }, wrap = THREE.ClampToEdgeWrapping) {
  const texture = new THREE.DataTexture(halves, width, height, THREE.RGBAFormat, THREE.HalfFloatType);
  texture.minFilter = texture.magFilter = THREE.LinearFilter;
  texture.wrapS = wrap;
  texture.needsUpdate = true;
  return texture;
}

/** The same for pictures of one size, one behind the other. */
export function halfTextures(pictures, { width, height }) {
  const halves = new Uint16Array(pictures.length * 4 * width * height);
  pictures.forEach((picture, k) => halves.set(picture, k * 4 * width * height));
  const texture = new THREE.DataArrayTexture(halves, width, height, pictures.length);
  texture.format = THREE.RGBAFormat;
  texture.type = THREE.HalfFloatType;
  texture.minFilter = texture.magFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}
