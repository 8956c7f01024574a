// Between glTF's roughness and Phong's highlight of [Rodriguez06, section 4.4.5].
#pragma once

#include "luxel/base/vec.h"

namespace luxel::scene {

/// glTF's mirror reflectance of non-metals, head on: that of the index of refraction 1.5.
inline constexpr float kDielectricF0 = 0.04f;

/// Phong's exponent n about the mirror direction R. A microfacet distribution of width alpha =
/// roughness^2 is about Blinn's (N.H)^m with m = 2 / alpha^2 - 2; the angle from R to the eye is
/// twice that from N to H, so (R.V)^n looks the same for n = m / 4. In [1, 10000].
float sharpness_of(float roughness);
/// The roughness that has this sharpness, in [0, 1].
float roughness_of(float sharpness);

/// C_s in the paper's units, where a facing white surface shows the light's own colour, that is pi
/// times its BRDF. A Phong lobe of BRDF f (R.V)^n reflects 2 pi f / (n + 1) of light that comes
/// along the normal; that this is F0 asks for C_s = pi f = F0 (n + 1) / 2. In [0, 1].
Rgb specular_of(Rgb f0, float sharpness);
/// F0 that has this C_s.
Rgb f0_of(Rgb specular, float sharpness);

}  // namespace luxel::scene
