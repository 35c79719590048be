// The controller stage: parameters and layers of each instance -> the voices of its pose, events and root motion
// (docs/controller.md).
#pragma once

#include "control/controller_io.h"
#include "gpu/kernel.h"

namespace throng {

// In the order of the bindings; dispatched with io::ControllerPush, an invocation per instance.
struct ControllerBuffers {
    BufferRange tables;      // ControllerTables::words; this and the next three are tables (gpu/table.glsl)
    BufferRange axes;        // io::ClipAxis[clip_count + 1], as words
    BufferRange times;       // float[], seconds
    BufferRange root_rows;   // (x, z, cos, sin)[]
    BufferRange layers;      // io::LayerState[instance_count][layer_count], read and written
    BufferRange parameters;  // float[instance_count][parameter_count], read; triggers are reset
    BufferRange voices;      // io::Voice[instance_count][voice_limit], written
    BufferRange events;      // io::EventHead, then io::EventRecord[event_capacity]; appended
    // io::RootState[instance_count], read and written where there is root motion; else any buffer
    BufferRange roots;
    BufferRange placements;  // world_from_model, Affine[instance_count], written where root motion is applied
    // io::InstanceInertia[instance_count], read and written where there are inertial transitions; else any buffer
    BufferRange inertias;
    BufferRange layers_before, parameters_before;  // layers and parameters once more, as tables of words
    // float[instance_count][voice_limit], seconds, written where the character has morphs; else any buffer
    BufferRange voice_times;
};
Kernel controller_kernel(const std::shared_ptr<Gpu>& gpu);

// In the order of the bindings; dispatched with io::CommandPush, an invocation per command.
struct CommandBuffers {
    BufferRange commands;    // io::ControlCommand[command_count]
    BufferRange layers;      // as above, written
    BufferRange parameters;  // as above, written
};
Kernel command_kernel(const std::shared_ptr<Gpu>& gpu);

}  // namespace throng
