#include "base/processor.h"

#include <fstream>

namespace throng {

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name"))
            if (const size_t at = line.find(": "); at != std::string::npos) return line.substr(at + 2);
    return "this machine's processor";
}

}  // namespace throng
