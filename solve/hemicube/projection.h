// What the elements of the first mesh send on behalf of the finer ones cut from it.
#pragma once

#include "solve/hemicube/receivers.h"

namespace luxel::hemicube {

/// A linear map from radiosity per element of the fine mesh to radiosity per sender.
struct Projection {
  struct Part {
    uint32_t element = 0;
    float weight = 0;
  };
  std::vector<uint32_t> first;  ///< per sender, one extra entry
  std::vector<Part> parts;
};

/// `fine` was cut from `sending`: its first nodes, and for light per vertex its first vertices, are
/// those of `sending`. Light per triangle: the mean over the area. Light per vertex: its own value,
/// plus what linear interpolation between senders loses of the fine light, shared out among the
/// corners:  B_v + integral of phi_v (B_fine - I B) / integral of phi_v,  phi_v the hat function of
/// sender v and I B the senders' interpolant. So the whole mesh sends exactly the power of the fine
/// light [Cohen86, eq. 8: patches send the mean of their elements], and a mesh that was not cut
/// sends its own values.
Projection project(const Mesh& sending_mesh, const Receivers& sending, const Mesh& fine_mesh,
                   const Receivers& fine);

/// Radiosity per sender.
std::vector<Rgb> sent(const Projection& projection, std::span<const Rgb> radiosity);

}  // namespace luxel::hemicube
