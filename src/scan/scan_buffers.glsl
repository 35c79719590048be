// What a scan that runs on its own reads and writes.
#include "gpu/buffers_io.h"

layout(local_size_x_id = 0) in;
layout(set = 0, binding = kLocalBuffer, std430) readonly buffer Local { StoredTransform local[]; };
layout(set = 0, binding = kScanLinksBuffer, std430) readonly buffer Links { uint links[]; };
layout(set = 0, binding = kModelBuffer, std430) SCAN_EXCHANGE buffer Model { StoredAffine model[]; };
layout(set = 0, binding = kScratchBuffer, std430) SCAN_EXCHANGE buffer Scratch { StoredAffine scratch[]; };
layout(push_constant) uniform Push { ScanPush push; };

uint link(uint index) { return links[index]; }

uint at(uint instance, uint joint) {
#ifdef SCAN_TRANSPOSED
    return joint * push.instance_count + instance;
#else
    return instance * push.joint_count + joint;
#endif
}
