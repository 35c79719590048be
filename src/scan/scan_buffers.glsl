// What a scan that runs on its own reads and writes.
layout(local_size_x_id = 0) in;
layout(set = 0, binding = 0, std430) readonly buffer Local { StoredTransform local[]; };
layout(set = 0, binding = 1, std430) readonly buffer Links { uint links[]; };
layout(set = 0, binding = 2, std430) SCAN_EXCHANGE buffer Model { StoredAffine model[]; };
layout(set = 0, binding = 3, std430) SCAN_EXCHANGE buffer Scratch { StoredAffine scratch[]; };
layout(push_constant) uniform Push { ScanPush push; };

uint link(uint index) { return links[index]; }

uint at(uint instance, uint joint) {
#ifdef SCAN_TRANSPOSED
    return joint * push.instance_count + instance;
#else
    return instance * push.joint_count + joint;
#endif
}
