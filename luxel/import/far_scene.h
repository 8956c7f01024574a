// Scenes far from the origin of their file, as houses in survey coordinates are: single precision
// has steps of half a metre at 5,000 km. They are moved before anything is rounded. For this room
// only.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "luxel/base/vec_double.h"
#include "luxel/import/import.h"

namespace luxel::import {

/// The origin to take for things in a box: 0 where its middle lies within eight times its size;
/// else the multiple of a power of two, one to two times the size, that is nearest to the middle.
/// So the steps of the file's own single precision are smaller than that power: the difference is
/// exact, and a scene that was moved by such a multiple gets its old coordinates back, bit by bit.
DVec3 origin_for(const DBox3& box);

/// Where a reader has put things, in double precision: as many as the scene has.
struct ExactPlaces {
  std::vector<DMat34> instances;  ///< world from the coordinates of the mesh
  std::vector<DVec3> lights, cameras;
  /// Meshes lie in coordinates relative to a point far from 0, which `instances` put back.
  bool is_relative = false;
  /// The largest step of single precision at places that were rounded before `instances` could be
  /// exact [m].
  double read_step_m = 0;
};

/// The doubles that a file has stated, as it seems, where a library has made floats of them: those
/// of the fewest digits that are these floats.
DMat34 as_stated(const Mat34& m);

/// The distance between a float and the next one, near `value`.
double float_step(double value);

/// Moves a scene that lies far from its origin towards it. With `wished` it takes that origin,
/// whatever it is. Returns what is to be told: where single precision had rounded before.
std::vector<std::string> move_towards_origin(const ExactPlaces& exact,
                                             const std::optional<DVec3>& wished,
                                             const std::string& file, Imported& imported);

}  // namespace luxel::import
