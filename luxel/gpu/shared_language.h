// Macros by which one text is C++ and GLSL: what the processor and a graphics device both read and
// write stands once, in files named *_shared.h. In C++ it lies in luxel::on_device, where names
// differ from those of all other such files. The rules of such a text: types are uint, int, float,
// double, vec2, vec3, vec4, uvec2, mat4, REF, ARRAY and structs of these; a number is `const uint`.
// Members lie as in C++, which is GLSL's scalar layout; a struct within another one has no gap at
// its end. None has a value of its own: in C++, Setup{} is all zeros.
//
//   IN_BUFFER(Floats, float);   an array in a buffer, which shaders read
//   OUT_BUFFER(Floats, float);  one that they write
//   BUFFER(Floats, float);      one that they read and write
//   VECTORS(Map);               an array of vec4 that they read, 16 bytes by 16 bytes
//   IN_BLOCK(Setup) { ... };    a struct in a buffer, which shaders read
//   BLOCK(Setup) { ... };       one that they read and write
//   PUSH(StepPush) { ... };     push constants: in GLSL, members are names of their own
//   REF(Floats) values;         the address of such a buffer
//   ARRAY(float, 3) values;     so many in a row
//   REST(float, values);        ends a block: so many as there are; C++ does not see it
#ifndef LUXEL_GPU_SHARED_LANGUAGE_H
#define LUXEL_GPU_SHARED_LANGUAGE_H

#ifdef VULKAN  // as GLSL has it
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#define SHARED_BEGIN
#define SHARED_END
#define BLOCK(Name) layout(buffer_reference, scalar) buffer Name
#define IN_BLOCK(Name) layout(buffer_reference, scalar) readonly buffer Name
#define PUSH(Name) layout(push_constant, scalar) uniform Name
#define BUFFER(Name, Type) \
  BLOCK(Name) { Type at[]; }
#define IN_BUFFER(Name, Type) \
  IN_BLOCK(Name) { Type at[]; }
#define OUT_BUFFER(Name, Type) \
  layout(buffer_reference, scalar) writeonly buffer Name { Type at[]; }
#define VECTORS(Name) \
  layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Name { vec4 at[]; }
#define REF(Name) Name
#define ARRAY(Type, count) Type[count]
#define REST(Type, name) Type name[]
#else
#include <array>
#include <cstdint>

#include "luxel/base/vec.h"

#define SHARED_BEGIN namespace luxel::on_device {
#define SHARED_END }
#define BLOCK(Name) struct Name
#define IN_BLOCK(Name) struct Name
#define PUSH(Name) struct Name
#define BUFFER(Name, Type) struct Name
#define IN_BUFFER(Name, Type) struct Name
#define OUT_BUFFER(Name, Type) struct Name
#define VECTORS(Name) struct Name
#define REF(Name) uint64_t
#define ARRAY(Type, count) std::array<Type, count>
#define REST(Type, name) static_assert(sizeof(Type) > 0)

namespace luxel::on_device {
using uint = uint32_t;
using vec2 = Vec2;
using vec3 = Vec3;
using vec4 = std::array<float, 4>;
using mat4 = std::array<float, 16>;  // column by column
struct uvec2 {
  uint x, y;
};
/// A number of 64 bits as shaders have it, its lower half in x.
inline uvec2 halves(uint64_t number) { return {uint(number), uint(number >> 32)}; }
}  // namespace luxel::on_device
#endif

#endif
