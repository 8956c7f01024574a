// Radiosity of elements and clusters: what is gathered over links is pushed down to the leaves and
// pulled up as means.
#pragma once

#include <cmath>

#include "luxel/solve/hierarchical/tree.h"

namespace luxel::hierarchical {

/// A sum of cosines, v max(0, d . n), as a function of the direction n: the irradiance from some
/// directions d, or the light that some surfaces with normals d send. Moments up to the second are
/// kept, which are the clamped cosine's first Legendre polynomials, 1/4 + x/2 + 5/32 (3 x^2 - 1):
/// within 0.1 of it, below 0 where it is 0, and the same in the mean over all directions.
/// [Ramamoorthi01]
struct Cosines {
  Rgb zeroth{};                 ///< sum of v
  std::array<Rgb, 3> first{};   ///< of v d
  std::array<Rgb, 6> second{};  ///< of v d d^T: xx, yy, zz, xy, yz, zx

  void add(Vec3 d, Rgb v) {
    zeroth += v;
    first[0] += v * d.x, first[1] += v * d.y, first[2] += v * d.z;
    second[0] += v * (d.x * d.x), second[1] += v * (d.y * d.y), second[2] += v * (d.z * d.z);
    second[3] += v * (d.x * d.y), second[4] += v * (d.y * d.z), second[5] += v * (d.z * d.x);
  }
  void add(const Cosines& other) {
    zeroth += other.zeroth;
    for (size_t k = 0; k < 3; ++k) first[k] += other.first[k];
    for (size_t k = 0; k < 6; ++k) second[k] += other.second[k];
  }
  /// v max(0, d . n), summed: with x = d . n the polynomials add up to 3/32 + x/2 + 15/32 x^2.
  Rgb at(Vec3 n) const {
    const Rgb one = first[0] * n.x + first[1] * n.y + first[2] * n.z;
    const Rgb two =
        second[0] * (n.x * n.x) + second[1] * (n.y * n.y) + second[2] * (n.z * n.z) +
        2 * (second[3] * (n.x * n.y) + second[4] * (n.y * n.z) + second[5] * (n.z * n.x));
    return zeroth * (3.0f / 32) + one * 0.5f + two * (15.0f / 32);
  }
};

struct ClusterLight {
  Cosines received;  ///< E over the links of this cluster
  Cosines sent;      ///< B A of the surfaces below [W]
  float most = 0;    ///< the largest component of B over the leaves below
};

/// Per element.
struct ElementLight {
  Rgb reflectance;
  Rgb emission;                 ///< B_e [W/m^2]
  std::array<Rgb, 4> received;  ///< E over the links of this element at its corners
  /// E at the corners of a leaf that no link brings: from punctual lights and the sky, and what
  /// exact light differs by from what links bring (feedback.h).
  std::array<Rgb, 4> unlinked;
  std::array<Rgb, 4> arriving;  ///< E at the corners, over the links of this and all above it
  std::array<Rgb, 4> shining;   ///< B at the corners, linear between them
  Rgb irradiance;               ///< E over all links, a mean [W/m^2]
  Rgb radiosity;                ///< B, a mean [W/m^2]
  float most = 0;               ///< the largest component of B over the leaves below
  float rough = 0;              ///< how far that is from linear, at most, over the leaves below
  float bend = 0;               ///< how far the pieces of a leaf are from linear
};

/// A triangle of a leaf, with B at its corners: finer than linear over the leaf.
struct LightPiece {
  std::array<DVec3, 4> corner;  ///< three
  std::array<Rgb, 4> radiosity;
};

struct Light {
  std::vector<ClusterLight> clusters;
  std::vector<ElementLight> elements;
  std::vector<LightPiece> pieces;     ///< of leaves, where exact light is known
  std::vector<uint32_t> first_piece;  ///< per element, one extra entry; or nothing
};

/// As if exact light was not known.
void drop_pieces(Light& light);

/// Sends `received` to the leaves, B = B_e + rho E there, and means back up. [Hanrahan91, PushPull]
void push_pull(const Faces& faces, const Tree& tree, Light& light);

}  // namespace luxel::hierarchical
