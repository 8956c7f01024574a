// Rays of a camera.

uvec2 path_seed(uvec2 seed, uint item, uint own_sample) {
  return hash64(hash64(seed, uvec2(item, 0)), uvec2(own_sample, 0));
}

// The ray of a sample of a pixel, and what is left of its random numbers.
Ray ray_of_pixel(Camera camera, uint pixel, uint own_sample, uvec2 seed, out Random random) {
  random = Random(path_seed(seed, pixel, own_sample), 0);
  vec2 jitter = next_vec2(random);
  uint width = uint(camera.width);
  float x = float(pixel % width) + jitter.x, y = float(pixel / width) + jitter.y;
  vec3 aside = camera.right * (2 * x / camera.width - 1) + camera.up * (1 - 2 * y / camera.height);
  if (camera.orthographic != 0) return Ray(camera.eye + aside, camera.forward, 0, kInfinity);
  return Ray(camera.eye, normalize(camera.forward + aside), 0, kInfinity);
}
