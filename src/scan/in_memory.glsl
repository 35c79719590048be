// The host of a method that runs as a stage of its own: local and model transforms are in memory.
#include "scan/scan_buffers.glsl"

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

void main() { scan(); }
