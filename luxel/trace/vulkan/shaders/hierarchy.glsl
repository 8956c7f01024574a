// trace(): what a ray meets, by the kind of hierarchy that the shader is compiled for (HierarchyKind).
#if defined(BINARY_HIERARCHY)
#include "binary.glsl"
#elif defined(WIDE_HIERARCHY)
#include "wide.glsl"
#elif defined(DRIVER_HIERARCHY)
#include "driver.glsl"
#endif
