// The capabilities of a solver. They decide which of the shared options it looks at.
#pragma once

namespace luxel::pipeline {

/// An option names the member that a solver must have to look at it; one that names none is for
/// every solver.
struct Capabilities {
  bool samples = false;         ///< traces rays or paths per texel: --samples
  bool direct_samples = false;  ///< traces shadow rays towards area lights: --direct-samples
  bool supersample = false;     ///< averages light over points of a texel: --supersample
  bool quality = false;         ///< has numbers for words: --quality
  bool errors = false;          ///< estimates each texel's standard error: --max-error,
                                ///< --error-map, --plan; keeps --time-budget by itself
  bool noise = false;           ///< estimates the variance of its light: --denoise
  bool layers = false;          ///< can tell each light apart: --layers
  bool direct = false;          ///< can tell direct light apart: --light
  bool scatters = false;        ///< follows light that surfaces scatter through
  bool parts = false;           ///< keeps its finished parts: --checkpoint, --resume
  bool teams = false;           ///< shares its work out among processes: mpirun
  bool keeps = false;           ///< leaves what later bakes can build on: --keep
  bool device = false;          ///< has rays that a graphics device can trace
  bool vertex_light = false;    ///< solves for light per vertex: --vertex-colors
};

}  // namespace luxel::pipeline
