// libFuzzer entry: any bytes as the commands that an application's shaders write.
#include "tests/fuzz/fuzz_crowd.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <vector>

using namespace throng;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static Crowd crowd = fuzz::make_crowd(true);
    static const std::vector<std::byte> initial = crowd.save_state().value();
    if (!crowd.restore_state(initial) || !crowd.update(0)) std::abort();
    for (uint32_t update = 0; update < 4 && size > 0; ++update) {
        for (const OutputBlock& block : crowd.outputs()) {
            if (block.host.command.empty() || size == 0) continue;
            block.host.command_head[0].count = *data++;  // may be more than there is room for
            --size;
            const size_t taken = std::min(size, block.host.command.size_bytes());
            std::memcpy(block.host.command.data(), data, taken);
            data += taken;
            size -= taken;
        }
        fuzz::use(crowd, update);
    }
    return 0;
}
