// The control stage: playback state -> time -> rows of keys.
#pragma once

#include "control/control_io.h"
#include "gpu/kernel.h"

namespace throng {

// In the order of the bindings; dispatched with io::ControlPush, an invocation per instance.
struct ControlBuffers {
    BufferRange playbacks;  // io::InstancePlayback[instance_count], read and written
    BufferRange axes;       // io::ClipAxis[clip_count + 1]
    BufferRange times;      // float[], seconds
    BufferRange cursors;    // io::InstanceCursor[instance_count], written
};

Kernel control_kernel(const std::shared_ptr<Gpu>& gpu);

}  // namespace throng
