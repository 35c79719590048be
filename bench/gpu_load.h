// GPUs lower their clocks while they have little to do. An H100 was seen at 345 of its 1,980 MHz between samples of a
// tenth of a millisecond; a copy took 1.8 times as long then as at full speed, and arithmetic 5.7 times.
#pragma once

#include "bench/rounds.h"
#include "bench/row_kernel.h"

#include <array>
#include <optional>

namespace throng::bench {

// Keeps a GPU busy before each sample. Does nothing on software and native devices.
class GpuLoad {
public:
    explicit GpuLoad(const std::shared_ptr<Gpu>& gpu);

    const Gpu& gpu() const { return *gpu_; }
    // Runs some milliseconds of work, or a tenth of a second if the GPU may have idled, and waits for it.
    void run() const;

private:
    struct Work {
        explicit Work(const std::shared_ptr<Gpu>& gpu);
        RowKernel kernel;
        std::array<Buffer, 2> buffers;
        Bindings bindings;
    };

    std::shared_ptr<Gpu> gpu_;
    std::unique_ptr<const Work> work_;
    mutable std::optional<Stopwatch> since_last_;
};

}  // namespace throng::bench
