import * as THREE from "three";

/**
 * Lights what GLTFLoader made of baked.glb with its lightmap, and with nothing else. `exr(name)`
 * resolves to what EXRLoader makes of the file, "lightmap.exr" or one for each page; without it the
 * pictures inside baked.glb, 8 bits, are used.
 */
export async function useLightmap(gltf, exr = null) {
  const lamps = [], meshes = [];
  gltf.scene.traverse((object) => {
    if (object.isLight) lamps.push(object);
    if (object.isMesh) meshes.push(object);
  });
  for (const lamp of lamps) lamp.removeFromParent(); // their light is in the lightmap
  const baked = new Map();
  for (const mesh of meshes) {
    if (!baked.has(mesh.material)) baked.set(mesh.material, await bakedMaterial(mesh.material, gltf.parser, exr));
    mesh.material = baked.get(mesh.material);
  }
}

async function bakedMaterial(loaded, parser, exr) {
  const lightmap = loaded.userData.gltfExtensions?.MOZ_lightmap;
  if (!lightmap) return loaded; // unlit: its colour as it is
  const picture = exr ? await exr(loaded.userData.luxel.lightmap)
    : await parser.getDependency("texture", lightmap.index);
  if (exr) picture.flipY = true; // EXRLoader has the bottom row first, glTF the top row
  else picture.colorSpace = THREE.SRGBColorSpace;
  picture.channel = lightmap.texCoord; // 1: TEXCOORD_1
  picture.needsUpdate = true;
  // Lambert, not Standard: that one (r187) takes away what its glossy coat would reflect.
  return new THREE.MeshLambertMaterial({
    color: loaded.color.clone().multiplyScalar(1 - (loaded.metalness ?? 0)),
    map: loaded.map ?? null,
    emissive: loaded.emissive ?? 0x000000,
    emissiveIntensity: loaded.emissiveIntensity ?? 1,
    emissiveMap: loaded.emissiveMap ?? null,
    lightMap: picture, // three shows color * lightMap * lightMapIntensity / pi
    lightMapIntensity: exr ? 1 : lightmap.intensity,
    alphaTest: loaded.alphaTest,
    side: loaded.side,
    vertexColors: loaded.vertexColors,
  });
}
