// The host of a method that runs as a stage of its own: local and model transforms are in memory.
#include "scan/scan_buffers.glsl"
#include "control/births.glsl"

// If instances come and go, how many a workgroup has; else 0. Workgroups none of whose instances are there do nothing.
CONSTANT(8, uint, kVaryingInstances, 0);

uint instance_count() { return push.instance_count; }
Transform load_local(uint instance, uint joint) { return unpack(local[at(instance, joint)]); }
void store_model(uint instance, uint joint, Transform model_from_joint) {
    model[at(instance, joint)] = pack(to_affine(model_from_joint));
}

#ifndef __cplusplus
void begin_instance(uint index) {}

void scan_barrier(bool through_buffers) {
    if (through_buffers)
        controlBarrier(gl_ScopeWorkgroup, gl_ScopeWorkgroup, gl_StorageSemanticsBuffer | gl_StorageSemanticsShared,
                       gl_SemanticsAcquireRelease);
    else
        barrier();
}
#endif

bool is_idle() {
    const uint first = gl_WorkGroupID.x * kVaryingInstances, end = min(first + kVaryingInstances, push.instance_count);
    for (uint instance = first; instance < end; ++instance)
        if (!is_free(instance)) return false;
    return true;
}

void main() {
    if (kVaryingInstances > 0 && is_idle()) return;
    scan();
}
