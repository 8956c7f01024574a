// view.html: a baked scene to walk around in. Nothing is fetched: the page carries it all.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { fitWindow, lookedAt, previewCamera } from "./camera.js";
import * as data from "./data.js";
import { connectLayers, layerColors } from "./layers.js";
import { backgroundMesh, bakedMaterial, halfTexture, halfTextures } from "./material.js";

const byId = (id) => document.getElementById(id);

/** What materials look up of each lightmap, by the name of its file. */
async function loadLight(about) {
  const pages = new Map();
  for (const page of about.light)
    pages.set(page.file, page.layers ? {
      light: { value: halfTextures(await Promise.all(page.layers.map(data.picture)), page) },
      layerScale: { value: page.layers.map(({ scale }) => scale) },
    } : {
      light: { value: halfTexture(await data.picture(page), page) },
      lightScale: { value: page.scale },
    });
  return pages;
}

async function loadSurroundings(about) {
  if (!about) return null;
  const texture = halfTexture(await data.picture(about), about, THREE.RepeatWrapping);
  return { texture, scale: about.scale, rotation: about.rotation };
}

/** The number of the layer that a mesh shines in, as its node in baked.glb says; -1: none. */
function layerOf(object, layers) {
  for (let o = object; o && layers; o = o.parent)
    if (o.userData.luxel?.layer) return layers.findIndex(({ name }) => name === o.userData.luxel.layer);
  return -1;
}

/** Meshes alone, with the bake's materials: lamps are in the lightmap already. */
async function loadScene(about, common) {
  const pages = await loadLight(about);
  const { scene } = await new GLTFLoader().parseAsync(await data.model(), "");
  const lamps = [];
  const known = new Map();
  scene.traverse((object) => {
    if (object.isLight) lamps.push(object);
    if (!object.isMesh) return;
    const layer = layerOf(object, about.layers);
    const key = [object.material.uuid, layer, ...Object.keys(object.geometry.attributes)].join();
    if (!known.has(key)) {
      const page = pages.get(object.material.userData.luxel?.lightmap);  // none: unlit
      known.set(key, bakedMaterial(object.material, object.geometry, page, common, layer));
    }
    object.material = known.get(key);
  });
  for (const lamp of lamps) lamp.removeFromParent();
  const sky = (about.layers ?? []).findIndex(({ surroundings }) => surroundings);
  scene.add(backgroundMesh(about.background, await loadSurroundings(about.surroundings), common, sky));
  return scene;
}

/** The room that surfaces take; the background's triangle is none. */
function boundsOf(scene) {
  const box = new THREE.Box3();
  scene.updateMatrixWorld(true);
  scene.traverse((o) => o.isMesh && o.renderOrder === 0 && box.expandByObject(o));
  return box;
}

function makeRenderer() {
  const renderer = new THREE.WebGLRenderer({ canvas: byId("canvas"), antialias: true });
  renderer.debug.onShaderError = (gl, program, vertex, fragment) => {
    throw new Error([vertex, fragment].map((s) => gl.getShaderInfoLog(s)).join("\n"));
  };
  return renderer;
}

/** "lightmap 512 x 512", "3 lightmaps 512 x 512", "9 lightmaps up to 256 x 256". */
function lightmapsOf({ light }) {
  const size = ({ width, height }) => `${width} x ${height}`;
  const largest = light.reduce((a, b) => (b.width > a.width ? b : a));
  const same = light.every((page) => size(page) === size(largest));
  return `${light.length > 1 ? `${light.length} lightmaps` : "lightmap"} ${same ? "" : "up to "}${size(largest)}`;
}

function fillPanel(about) {
  document.title = `${about.title} - luxel`;
  byId("title").textContent = about.title;
  byId("numbers").textContent = `${about.triangles.toLocaleString("en")} triangles, ${lightmapsOf(about)}`;
  byId("panel").open = innerWidth > 600;
  byId("panel").hidden = false;
}

/** `wishes`: the words after # in the page's address; light and colour choose what is shown first. */
function connectPanel(about, common, controls, draw, wishes, resetLayers) {
  const expose = () => {
    const stops = Number(byId("exposure").value);
    common.exposure.value = about.preview.exposure * 2 ** stops;
    byId("stops").textContent = `${stops > 0 ? "+" : ""}${stops.toFixed(1)} stops`;
    draw();
  };
  const choices = [...document.getElementsByName("show")];
  const choose = (choice) => {
    choice.checked = true;
    common.show.value = choices.indexOf(choice);
    draw();
  };
  for (const choice of choices) choice.addEventListener("change", () => choose(choice));
  byId("exposure").addEventListener("input", expose);
  byId("reset").addEventListener("click", () => {
    byId("exposure").value = 0;
    resetLayers();
    controls.reset();
    choose(choices[0]);
    expose();
  });
  addEventListener("keydown", (event) => choices[Number(event.key) - 1] && choose(choices[Number(event.key) - 1]));
  const wanted = wishes.find((word) => word.startsWith("stops="));
  if (wanted) byId("exposure").value = wanted.slice(6);
  expose();
  choose(choices.find((choice) => wishes.includes(choice.value)) ?? choices[0]);
}

async function open() {
  const about = data.about();
  const renderer = makeRenderer();
  const side = Math.max(...about.light.map(({ width, height }) => Math.max(width, height)));
  if (side > renderer.capabilities.maxTextureSize)
    throw new Error(`This device supports textures of up to ${renderer.capabilities.maxTextureSize} texels a side; the lightmap has ${side}.`);
  const common = {
    exposure: { value: about.preview.exposure },
    show: { value: 0 },
    ...(about.layers && { layerColor: { value: layerColors(about.layers) } }),
  };
  const scene = await loadScene(about, common);
  const box = boundsOf(scene);
  const camera = previewCamera(about.preview, box.getSize(new THREE.Vector3()).length() || 1);
  let asked = false;
  const draw = () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      renderer.render(scene, camera);
    });
  };
  const resize = () => {
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    renderer.setSize(innerWidth, innerHeight, false);
    fitWindow(camera, innerWidth, innerHeight);
    renderer.render(scene, camera);
  };
  resize();
  const target = lookedAt(camera, scene, box), from = camera.position.clone();
  const controls = new OrbitControls(camera, byId("canvas"));  // turns the camera to the origin
  controls.zoomToCursor = true;
  controls.target.copy(target);
  camera.position.copy(from);
  controls.update();
  controls.saveState();
  controls.addEventListener("change", draw);
  addEventListener("resize", resize);
  const wishes = location.hash.slice(1).split(",");
  document.body.classList.toggle("bare", wishes.includes("bare"));
  fillPanel(about);
  const reset = about.layers ? connectLayers(about.layers, common.layerColor.value, draw, wishes) : () => {};
  connectPanel(about, common, controls, draw, wishes, reset);
  resize();
  byId("message").hidden = true;
}

/** Resolves when the first picture stands. */
window.luxelReady = open().catch((error) => {
  byId("message").textContent = `The scene cannot be shown: ${error.message}`;
  throw error;
});
