// A slider and a colour for each layer of light. Their product is a factor of the layer's light.
import * as THREE from "three";

/** One factor for each layer, 1 to begin with. */
export const layerColors = (layers) => layers.map(() => new THREE.Vector3(1, 1, 1));

/** A row of the panel: the name, a colour, how bright. */
function rowOf({ name, lights }) {
  const row = document.createElement("div");
  row.className = "layer";
  row.title = lights.join(", ");
  const label = document.createElement("span");
  label.textContent = name;
  const input = (type, attributes) =>
    Object.assign(document.createElement("input"), { type, ...attributes });
  const color = input("color", { value: "#ffffff" });
  color.setAttribute("aria-label", `Colour of ${name}`);
  const level = input("range", { min: 0, max: 2, step: 0.01, value: 1 });
  level.setAttribute("aria-label", `Brightness of ${name}`);
  const shown = document.createElement("output");
  row.append(color, label, shown, level);
  return { row, color, level, shown };
}

/** "lamp=0.5" or "lamp=0.5:ff8800" of the page's address. */
function wishOf(name, wishes) {
  const wish = wishes.find((word) => word.startsWith(`${name}=`));
  if (!wish) return {};
  const [level, color] = wish.slice(name.length + 1).split(":");
  return { level, color: color && `#${color}` };
}

/** Fills the panel; returns what sets all back to 1. `factors` are those of layerColors. */
export function connectLayers(layers, factors, draw, wishes) {
  const box = document.getElementById("layers");
  const rows = layers.map((layer, k) => {
    const { row, color, level, shown } = rowOf(layer);
    const linear = new THREE.Color();
    const change = () => {
      linear.set(color.value);  // to linear light
      factors[k].set(linear.r, linear.g, linear.b).multiplyScalar(Number(level.value));
      shown.textContent = Number(level.value).toFixed(2);
      draw();
    };
    const set = (wish) => {
      level.value = wish.level ?? 1;
      color.value = wish.color ?? "#ffffff";
      change();
    };
    color.addEventListener("input", change);
    level.addEventListener("input", change);
    set(wishOf(layer.name, wishes));
    box.append(row);
    return set;
  });
  box.hidden = false;
  return () => rows.forEach((set) => set({}));
}
