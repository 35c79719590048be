// Types that C++ and GLSL both know, so that a <stage>_io.h reads the same on either side. Layouts are std430.
#ifndef THRONG_GPU_SHADER_TYPES_H
#define THRONG_GPU_SHADER_TYPES_H

#ifdef __cplusplus
#include "gpu/vectors.h"
#define THRONG_IO_BEGIN namespace throng::io {
#define THRONG_IO_END }
#define THRONG_IO_CONSTANT inline constexpr uint
#define THRONG_IO_FLOAT inline constexpr float
#define INOUT(type) type&
#else
#define THRONG_IO_BEGIN
#define THRONG_IO_END
#define THRONG_IO_CONSTANT const uint
#define THRONG_IO_FLOAT const float
#define INOUT(type) inout type
#include "gpu/declare.glsl"
// Type names for texts that C++ also compiles with other types, some of several lanes (gpu/glsl.h)
#define Real float
#define Whole int
#define Mask bool
#define truncated(real) int(real)
#define choose(condition, yes, no) ((condition) ? (yes) : (no))
#define some(condition) (condition)  // in any lane
const uint kNone = 0xFFFFFFFFu;  // as throng::kNone
#endif

#endif
