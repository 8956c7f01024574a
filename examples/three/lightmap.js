import * as THREE from "three";

/** Lights what GLTFLoader made of baked.glb with the lightmap inside it, and with nothing else. */
export async function useLightmap(gltf) {
  const lamps = [], meshes = [];
  gltf.scene.traverse((object) => {
    if (object.isLight) lamps.push(object);
    if (object.isMesh) meshes.push(object);
  });
  for (const lamp of lamps) lamp.removeFromParent(); // their light is in the lightmap
  const baked = new Map();
  for (const mesh of meshes) {
    if (!baked.has(mesh.material)) baked.set(mesh.material, await bakedMaterial(mesh.material, gltf.parser));
    mesh.material = baked.get(mesh.material);
  }
}

async function bakedMaterial(loaded, parser) {
  const lightmap = loaded.userData.gltfExtensions.MOZ_lightmap;
  const picture = await parser.getDependency("texture", lightmap.index);
  picture.colorSpace = THREE.SRGBColorSpace;
  picture.channel = lightmap.texCoord; // 1: TEXCOORD_1
  // Lambert, not Standard: that one (r187) takes away what its glossy coat would reflect.
  return new THREE.MeshLambertMaterial({
    color: loaded.color.clone().multiplyScalar(1 - (loaded.metalness ?? 0)),
    map: loaded.map ?? null,
    emissive: loaded.emissive ?? 0x000000,
    emissiveIntensity: loaded.emissiveIntensity ?? 1,
    emissiveMap: loaded.emissiveMap ?? null,
    lightMap: picture, // three shows color * lightMap * lightMapIntensity / pi
    lightMapIntensity: lightmap.intensity,
    alphaTest: loaded.alphaTest,
    side: loaded.side,
    vertexColors: loaded.vertexColors,
  });
}
