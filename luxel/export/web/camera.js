// The camera of preview.png.
import * as THREE from "three";

const axis = (matrix, column) => new THREE.Vector3().setFromMatrixColumn(matrix, column).normalize();

/** A camera that shows what `preview` shows, and at least that in a window of another shape. */
export function previewCamera(preview, diagonal) {
  const { matrix, yfov, height_m: height } = preview.camera;
  const camera = height > 0 ? new THREE.OrthographicCamera() : new THREE.PerspectiveCamera();
  const placed = new THREE.Matrix4().fromArray(matrix);
  const right = axis(placed, 0), up = axis(placed, 1), back = axis(placed, 2);
  camera.matrix.makeBasis(right, up, back).setPosition(...matrix.slice(12, 15));
  camera.matrix.decompose(camera.position, camera.quaternion, camera.scale);
  // Orbiting keeps `up` upright: the world's, unless this camera is rolled or looks along it.
  const upright = Math.abs(right.y) < 1e-4 && up.y > 1e-3;
  camera.up.copy(upright ? new THREE.Vector3(0, 1, 0) : up);
  camera.near = 1e-3 * diagonal;
  camera.far = camera.position.length() + 20 * diagonal;
  if (height > 0) camera.near = -camera.far;
  camera.userData.shape = { preview, yfov, height };
  return camera;
}

/** A window narrower than the picture shows the picture's whole width. */
export function fitWindow(camera, width, height) {
  const { preview, yfov, height: height_m } = camera.userData.shape;
  const aspect = width / height;
  const wanted = Math.max(preview.camera.aspect, preview.width / preview.height);
  const widen = Math.max(1, wanted / aspect);
  if (camera.isPerspectiveCamera) {
    camera.aspect = aspect;
    camera.fov = THREE.MathUtils.radToDeg(2 * Math.atan(Math.tan(yfov / 2) * widen));
  } else {
    const half = 0.5 * height_m * widen;
    Object.assign(camera, { top: half, bottom: -half, left: -half * aspect, right: half * aspect });
  }
  camera.updateProjectionMatrix();
}

/** The point to turn around: what the middle of the picture shows, else as far as the scene's middle. */
export function lookedAt(camera, model, box) {
  camera.updateMatrixWorld();
  const ray = new THREE.Raycaster();
  ray.setFromCamera(new THREE.Vector2(0, 0), camera);
  const hit = ray.intersectObject(model, true)[0];
  if (hit) return hit.point;
  const ahead = camera.getWorldDirection(new THREE.Vector3());
  const along = box.getCenter(new THREE.Vector3()).sub(camera.position).dot(ahead);
  return camera.position.clone().addScaledVector(ahead, Math.max(along, 1e-2 * box.getSize(ahead.clone()).length()));
}
