// The interface of every scan method. constant_id 0 is the workgroup size. A method writes model[] and may use scratch[], which has
// the same shape; it never writes local[]. links[] is the method's own table of the skeleton, from scan_table.cpp.
// A method whose invocations exchange matrices through model[] or scratch[] defines SCAN_EXCHANGE as coherent.
#include "gpu/affine.glsl"
#include "scan/scan_io.h"

#ifndef SCAN_EXCHANGE
#define SCAN_EXCHANGE
#endif

layout(local_size_x_id = 0) in;
layout(set = 0, binding = 0, std430) readonly buffer Local { Affine local[]; };
layout(set = 0, binding = 1, std430) readonly buffer Links { uint links[]; };
layout(set = 0, binding = 2, std430) SCAN_EXCHANGE buffer Model { Affine model[]; };
layout(set = 0, binding = 3, std430) SCAN_EXCHANGE buffer Scratch { Affine scratch[]; };
layout(push_constant) uniform Push { ScanPush push; };
