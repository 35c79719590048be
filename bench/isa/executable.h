// What a driver reports about a pipeline that it has made (VK_KHR_pipeline_executable_properties).
#pragma once

#include "bench/isa/machine_code.h"
#include "bench/isa/machines.h"
#include "gpu/gpu.h"

#include <string>

namespace throng::bench {

// One kernel, or one stage of a graphics pipeline, as AMD's driver makes it.
struct Executable {
    std::string name;             // of the kernel; of a graphics pipeline also which stage
    uint32_t workgroup_size = 0;  // 0: of a graphics pipeline
    uint32_t subgroup_size = 0;
    uint32_t vgprs = 0, sgprs = 0, spilled_vgprs = 0, spilled_sgprs = 0;  // of a lane (VGPRs) and a subgroup (SGPRs)
    uint32_t scratch_bytes = 0, shared_bytes = 0;                         // of a subgroup; of a workgroup
    MachineCode code;

    KernelNeeds needs() const { return {subgroup_size, workgroup_size, vgprs, shared_bytes}; }
};

std::vector<Executable> executables_of(const Gpu& gpu, const MadePipeline& made);

}  // namespace throng::bench
