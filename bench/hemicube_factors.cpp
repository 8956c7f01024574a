// Form factors between two squares by the solver's own hemicubes, against closed forms.
#include <cmath>

#include "bench/hemicube.h"
#include "luxel/base/file.h"
#include "luxel/base/text_tables.h"
#include "luxel/scene/shapes.h"
#include "luxel/viewfactor/point_form_factor.h"
#include "luxel/viewfactor/quadrature.h"

namespace luxel::bench {
namespace {

using viewfactor::Polygon;

/// Nodes along each side of the square that is looked from.
constexpr int kNodes = 8;

struct Squares {
  std::string name;
  Polygon a, b;
  double exact = 0;
};

Result<Squares> find_row(std::string_view csv, const std::string& name,
                         const std::filesystem::path& file) {
  for (const TextRow& cells : csv_rows(csv)) {
    if (cells.size() < 6 || cells[0] != name) continue;
    Squares s{name, {}, {}, 0};
    LUXEL_TRY(s.a, parse_polygon(cells[2]));
    LUXEL_TRY(s.b, parse_polygon(cells[3]));
    LUXEL_TRY(s.exact, parse_number(cells[5]));
    if (s.a.size() == 4 && s.b.size() == 4) return s;
  }
  return fail(ErrorCode::bad_input, "{}: row '{}' with two squares is not there", file.string(),
              name);
}

scene::Scene scene_of(const Squares& s) {
  scene::Scene scene;
  scene::add_material(scene, "black", {});
  for (const Polygon* p : {&s.a, &s.b}) {
    scene::Mesh mesh;
    scene::add_quad(
        mesh, {to_float((*p)[0]), to_float((*p)[1]), to_float((*p)[2]), to_float((*p)[3])}, 0);
    scene::place(scene, std::move(mesh));
  }
  return scene;
}

struct Point {
  DVec3 position;
  double weight = 0;  ///< they sum to 1
  double exact = 0;   ///< F from there
};

std::vector<Point> gauss_points(const Squares& s, DVec3 normal) {
  std::vector<Point> points;
  for (const viewfactor::Node& u : viewfactor::gauss_rule(kNodes))
    for (const viewfactor::Node& v : viewfactor::gauss_rule(kNodes)) {
      const DVec3 p = s.a[0] + (s.a[1] - s.a[0]) * u.at + (s.a[3] - s.a[0]) * v.at;
      points.push_back({p, u.weight * v.weight, viewfactor::point_to_polygon(p, normal, s.b)});
    }
  return points;
}

/// F from each point to the second instance, as the solver's hemicubes see it.
Result<std::vector<double>> seen_factors(const hemicube::Senders& senders,
                                         std::span<const hemicube::Viewpoint> from, int resolution,
                                         Progress& progress) {
  std::vector<double> factor(from.size());
  const auto add_up = [&](size_t i, const hemicube::View& view) -> Status {
    for (size_t k = 0; k < view.element.size(); ++k) {
      const uint32_t node = senders.receivers.leaves[view.element[k]];
      if (senders.mesh.nodes[node].instance == 1) factor[i] += double(view.share[k]);
    }
    return {};
  };
  LUXEL_TRY(const hemicube::LookSeconds seconds,
            hemicube::look(senders, from, {resolution}, add_up, progress));
  static_cast<void>(seconds);
  return factor;
}

Status measure_squares(const Squares& s, std::vector<FactorErrors>& out, Progress& progress) {
  // The two squares as a scene.
  const scene::Scene scene = scene_of(s);
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  LUXEL_TRY(const hemicube::Mesh mesh, hemicube::make_mesh(scene, {}, progress));
  const auto receivers = hemicube::make_receivers(scene, mesh, hemicube::ElementKind::triangle);
  const light::Surroundings around;
  const hemicube::Senders senders{scene, tracer, mesh, receivers, around};
  // Viewpoints are Gauss points of the first square.
  const DVec3 normal = normalize(viewfactor::area_vector(s.a));
  const std::vector<Point> points = gauss_points(s, normal);
  std::vector<hemicube::Viewpoint> from;
  for (const Point& p : points)
    from.push_back({to_float(p.position), to_float(normal), to_float(normal)});
  // Finer and finer hemicubes against the exact factors of the points and of the whole.
  for (const int n : {8, 16, 32, 64, 128, 256, 512}) {
    progress.begin("view factors", from.size());
    LUXEL_TRY(const std::vector<double> factor, seen_factors(senders, from, n, progress));
    double mean = 0, squares = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      const double error = factor[i] / points[i].exact - 1;
      mean += points[i].weight * factor[i];
      squares += error * error / double(points.size());
    }
    out.push_back({s.name, n, std::abs(mean / s.exact - 1), std::sqrt(squares)});
  }
  return {};
}

}  // namespace

Result<std::vector<FactorErrors>> measure_hemicube_factors(const std::filesystem::path& file,
                                                           Progress& progress) {
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(file));
  const std::string_view csv(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::vector<FactorErrors> out;
  for (const char* name : {"par-01", "perp-01"}) {
    LUXEL_TRY(const Squares squares, find_row(csv, name, file));
    LUXEL_TRY_STATUS(measure_squares(squares, out, progress));
  }
  return out;
}

}  // namespace luxel::bench
