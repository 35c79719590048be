#include "base/processor.h"

#include <sched.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <thread>

namespace throng {

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name"))
            if (const size_t at = line.find(": "); at != std::string::npos) return line.substr(at + 2);
    return "this machine's processor";
}

uint32_t processor_threads() {
    uint32_t threads = std::max(1u, std::thread::hardware_concurrency());
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0)
        threads = std::clamp(static_cast<uint32_t>(CPU_COUNT(&allowed)), 1u, threads);
    // The CPU limit of a container, as cgroup v2 exposes it: "150000 100000" allows 150,000 us of CPU time in each
    // period of 100,000 us; "max" in place of the first number means no limit
    std::ifstream file("/sys/fs/cgroup/cpu.max");
    double quota_us = 0, period_us = 0;
    if (file >> quota_us >> period_us && quota_us > 0 && period_us > 0)
        threads = static_cast<uint32_t>(std::clamp(std::ceil(quota_us / period_us), 1.0, static_cast<double>(threads)));
    return threads;
}

}  // namespace throng
