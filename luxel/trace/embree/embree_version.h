// Version and packets of Embree, the ray tracer of the processor.
#pragma once

#include <string>

namespace luxel::trace {

/// The library that was linked, and the widest packets of rays that it traces on this processor.
struct EmbreeVersion {
  std::string number;        ///< "3.13.5"
  int rays_in_a_packet = 0;  ///< 0: it does not run on this processor
};

/// Opens Embree for a moment.
EmbreeVersion embree_version();

}  // namespace luxel::trace
