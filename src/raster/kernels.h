// The kernel of an instruction set.
#pragma once

#include "native/native.h"
#include "raster/frame.h"

namespace throng::raster {

// One of native_isas().
const Kernel& kernel_of(NativeIsa isa);

}  // namespace throng::raster
