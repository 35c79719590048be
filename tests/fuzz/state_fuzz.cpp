// libFuzzer entry: a saved state in which words are replaced; it is refused, or the crowd goes on from it. Each 8 bytes
// of input are the place of a word and its new value.
#include "base/crc64.h"
#include "tests/fuzz/fuzz_crowd.h"

#include <cstdlib>
#include <cstring>
#include <vector>

using namespace throng;

namespace {

// A crowd, and a state that it had.
struct SavedCrowd {
    Crowd crowd;
    std::vector<std::byte> state;

    explicit SavedCrowd(bool shaders_populate) : crowd(fuzz::make_crowd(shaders_populate)) {
        for (uint32_t update = 0; update < 4; ++update) fuzz::use(crowd, update);
        state = crowd.save_state().value();
    }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static SavedCrowd crowds[2]{SavedCrowd(false), SavedCrowd(true)};
    if (size < 9) return 0;
    Crowd& crowd = crowds[data[0] % 2].crowd;
    std::vector<std::byte> state = crowds[data[0] % 2].state;
    if (!crowd.restore_state(state)) std::abort();
    constexpr size_t kHead_bytes = 72;  // checked field by field
    const size_t word_count = (state.size() - kHead_bytes - sizeof(uint64_t)) / 4;
    for (size_t at = 1; at + 8 <= size; at += 8) {
        uint32_t word;
        std::memcpy(&word, data + at, 4);
        std::memcpy(state.data() + kHead_bytes + word % word_count * 4, data + at + 4, 4);
    }
    const size_t end = state.size() - sizeof(uint64_t);
    const uint64_t checksum = crc64(std::span(state).first(end));
    std::memcpy(state.data() + end, &checksum, sizeof checksum);
    const Result<void> restored = crowd.restore_state(state);
    if (!restored) fuzz::check_refusal(restored.error(), "crowd state");
    for (uint32_t update = 0; update < 3; ++update) fuzz::use(crowd, update);
    if (!crowd.save_state()) std::abort();
    return 0;
}
