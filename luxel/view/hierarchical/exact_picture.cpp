#include "luxel/view/hierarchical/exact_picture.h"

#include <algorithm>

#include "luxel/solve/hierarchical/surface.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;

constexpr int kCoarsest = 16;        ///< the side of the first grid's squares [pixels]
constexpr double kTolerance = 1e-3;  ///< PointParams::tolerance, as `luxel render` has it

/// The pixels in their order from `first` on: those of a grid of 16, then of 8 that are not on it,
/// and so on.
std::vector<size_t> ordered_pixels(const ExactView& view, size_t first, size_t count) {
  std::vector<size_t> out;
  size_t number = 0;
  for (int step = kCoarsest; step >= 1; step /= 2)
    for (int y = 0; y < view.height; y += step)
      for (int x = 0; x < view.width; x += step) {
        const bool was_before = step < kCoarsest && x % (2 * step) == 0 && y % (2 * step) == 0;
        if (was_before || number++ < first) continue;
        out.push_back(size_t(y) * size_t(view.width) + size_t(x));
        if (out.size() == count) return out;
      }
  return out;
}

}  // namespace

bool is_same(const ExactView& a, const ExactView& b) {
  const scene::Camera &c = a.camera, &d = b.camera;
  return a.width == b.width && a.height == b.height && c.fov_y_rad == d.fov_y_rad &&
         c.orthographic_height_m == d.orthographic_height_m && c.aspect == d.aspect &&
         c.world_from_camera == d.world_from_camera;
}

ExactPicture begin_exact(const Piece& piece, const ExactView& view) {
  ExactPicture out;
  out.view = view, out.piece = piece.number;
  out.pixels.resize(size_t(view.width) * size_t(view.height));
  return out;
}

bool is_whole(const ExactPicture& picture) { return picture.done >= picture.pixels.size(); }

Status add_exact(const Piece& piece, const SolvedScene& in, size_t count, ExactPicture& picture,
                 Progress& progress) {
  const h::Solution& s = piece.solution();
  const trace::CameraRays camera(picture.view.camera, picture.view.width, picture.view.height);
  const std::vector<size_t> pixels = ordered_pixels(picture.view, picture.done, count);
  // Hits of rays through the middles of the pixels.
  std::vector<trace::Ray> rays;
  for (const size_t pixel : pixels)
    rays.push_back(camera.through(float(pixel % size_t(picture.view.width)) + 0.5f,
                                  float(pixel / size_t(picture.view.width)) + 0.5f));
  const std::vector<trace::Hit> hits = trace::visible_hits(in.scene, in.tracer, rays);
  std::vector<h::Receiver> receivers;
  std::vector<size_t> pixel_of;
  for (size_t k = 0; k < hits.size(); ++k) {
    if (!hits[k].found()) continue;
    const h::FacePoint place = h::face_point_of(in.scene, s.faces, hits[k].point());
    if (place.face == h::kNone) continue;
    receivers.push_back(h::receiver_at(s, in.scene, in.tracer, place.face, place.position));
    pixel_of.push_back(pixels[k]);
  }
  LUXEL_TRY(const std::vector<Rgb> light,
            h::irradiance_at(s, in.scene, in.tracer, receivers, {kTolerance}, progress));
  for (size_t k = 0; k < light.size(); ++k)
    picture.pixels[pixel_of[k]] = {light[k], receivers[k].face};
  picture.done += pixels.size();
  return {};
}

}  // namespace luxel::view
