// Shows baked.glb as preview.png does: same camera, same exposure.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { EXRLoader } from "three/addons/loaders/EXRLoader.js";
import { useLightmap } from "./lightmap.js";

async function show() {
  const gltf = await new GLTFLoader().loadAsync("baked.glb");
  const files = new Map(); // one lightmap, or one for each page, which several materials share
  const exr = (name) => {
    if (!files.has(name)) files.set(name, new EXRLoader().loadAsync(name));
    return files.get(name);
  };
  await useLightmap(gltf, location.search === "?exr" ? exr : null);
  const { preview } = await (await fetch("bake.json")).json();

  const camera = new THREE.PerspectiveCamera(
    THREE.MathUtils.radToDeg(preview.camera.yfov), innerWidth / innerHeight, 0.01, 1000);
  camera.applyMatrix4(new THREE.Matrix4().fromArray(preview.camera.matrix));

  const renderer = new THREE.WebGLRenderer({ antialias: true });
  renderer.setSize(innerWidth, innerHeight);
  renderer.toneMapping = THREE.LinearToneMapping; // or any other of three's curves
  renderer.toneMappingExposure = preview.exposure;
  document.body.append(renderer.domElement);
  renderer.render(gltf.scene, camera);
}

window.luxelReady = show();
