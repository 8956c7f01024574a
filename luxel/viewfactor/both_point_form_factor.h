// Lambert's formula for the form factor from a point to a polygon, whose edges arrive one after
// another: point_form_factor.h. C++ and GLSL.
#ifndef LUXEL_VIEWFACTOR_BOTH_POINT_FORM_FACTOR_H
#define LUXEL_VIEWFACTOR_BOTH_POINT_FORM_FACTOR_H
#include "luxel/base/both_language.h"
#ifdef VULKAN
#define to_double dvec3
#else
#include "luxel/base/vec_double.h"
namespace luxel::both {
using dvec3 = DVec3;
}
#endif
BOTH_BEGIN

// atan2(sine, cosine) where the sine is above 0, off by less than 4e-16 of it: three ranges, and
// in each a quotient of polynomials [Moshier89, atan]. Half of the time of atan2, which looks for
// special cases and rounds the last bit.
BOTH double angle_of_sine(double sine, double cosine) {
  const double pi = DOUBLE(3.14159265358979323846);
  const double tan_quarter = DOUBLE(0.41421356237309505),
               tan_three_quarters = DOUBLE(2.414213562373095);
  const double across = abs(cosine);
  double base = DOUBLE(0), rise = sine, run = across;
  if (sine > tan_three_quarters * across) {
    base = pi / 2, rise = -across, run = sine;
  } else if (sine > tan_quarter * across) {
    base = pi / 4, rise = sine - across, run = sine + across;
  }
  const double t = rise / run, z = t * t;
  const double p =
      (((DOUBLE(-8.750608600031904122785e-1) * z - DOUBLE(1.615753718733365076637e1)) * z -
        DOUBLE(7.500855792314704667340e1)) *
           z -
       DOUBLE(1.228866684490136173410e2)) *
          z -
      DOUBLE(6.485021904942025371773e1);
  const double q =
      ((((z + DOUBLE(2.485846490142306297962e1)) * z + DOUBLE(1.650270098316988542046e2)) * z +
        DOUBLE(4.328810604912902668951e2)) *
           z +
       DOUBLE(4.853903996359136964868e2)) *
          z +
      DOUBLE(1.945506571482613964425e2);
  const double angle = base + (t + t * z * p / q);
  return cosine < 0 ? pi - angle : angle;
}

// Lambert's sum over the edges of a polygon, seen from the origin.
struct EdgeSum {
  dvec3 normal;
  dvec3 first, last;  // corners so far
  int count;
  double sum;
};
BOTH EdgeSum no_edges(dvec3 normal) {
  EdgeSum e;
  e.normal = normal, e.first = normal, e.last = normal, e.count = 0, e.sum = DOUBLE(0);
  return e;
}
BOTH void add_edge(INOUT(EdgeSum) e, dvec3 p, dvec3 q) {
  const dvec3 across = cross(p, q);
  const double sine = length(across);
  if (sine > 0) e.sum += angle_of_sine(sine, dot(p, q)) * dot(across, e.normal) / sine;
}
BOTH void add_corner(INOUT(EdgeSum) e, dvec3 p) {
  if (e.count == 0)
    e.first = p;
  else
    add_edge(e, e.last, p);
  e.count = e.count + 1;
  e.last = p;
}
// Adds the side from p to q, whose heights are hp and hq, as far as it lies above the horizon. The
// rest is clipped away on the fly [Sutherland74].
BOTH void add_side(INOUT(EdgeSum) e, dvec3 p, double hp, dvec3 q, double hq) {
  if (hp >= 0) add_corner(e, p);
  if ((hp > 0 && hq < 0) || (hp < 0 && hq > 0)) add_corner(e, p + (q - p) * (hp / (hp - hq)));
}
// The form factor, once all sides are there. Corners that are counter-clockwise seen from the point
// run clockwise about the direction to it.
BOTH double closed_factor(EdgeSum e) {
  if (e.count < 3) return DOUBLE(0);
  add_edge(e, e.last, e.first);
  return max(DOUBLE(0), -e.sum / (2 * DOUBLE(3.14159265358979323846)));
}

// The factor from a point to a triangle.
BOTH double point_to_triangle(vec3 point, vec3 normal, vec3 a, vec3 b, vec3 c) {
  const dvec3 p = to_double(a) - to_double(point), q = to_double(b) - to_double(point),
              r = to_double(c) - to_double(point), n = to_double(normal);
  const double hp = dot(p, n), hq = dot(q, n), hr = dot(r, n);
  EdgeSum e = no_edges(n);
  add_side(e, p, hp, q, hq);
  add_side(e, q, hq, r, hr);
  add_side(e, r, hr, p, hp);
  return closed_factor(e);
}

BOTH_END
#endif
