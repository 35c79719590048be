// AMD's driver without its hardware: it compiles for any GPU family that it is asked for.
#pragma once

#include "bench/isa/executable.h"
#include "scan/scan.h"

#include <functional>
#include <string>

namespace throng::bench {

// Opens the driver for a family that RADV_FORCE_FAMILY knows (bench/isa/machines.h). Looks for the driver where the
// Vulkan loader does, unless VK_DRIVER_FILES or VK_ICD_FILENAMES say where it is. Throws kNoDevice if it is not
// installed. Changes the environment while the device is made: other threads must not read it then.
std::shared_ptr<Gpu> open_compiler(const std::string& family);

// Compiles for subgroups of one size, and captures the result.
class Compiler {
public:
    Compiler(const std::string& family, uint32_t subgroup_size);  // throws as open_compiler()
    ~Compiler();
    Compiler(const Compiler&) = delete;

    const std::shared_ptr<Gpu>& gpu() const { return gpu_; }
    ScanLimits scan_limits() const;

    // Returns the kernels, and the stages of graphics pipelines, that are made while `make` runs.
    std::vector<Executable> made_by(const std::function<void()>& make) const;

private:
    std::shared_ptr<Gpu> gpu_;
};

}  // namespace throng::bench
