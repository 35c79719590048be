// libFuzzer entry: any bytes as a compiled character, whose size and checksum are made to fit; then a crowd of it.
#include "compile/file/character_file.h"
#include "compile/file/character_layout.h"
#include "tests/fuzz/fuzz_crowd.h"

#include <cstring>
#include <vector>

using namespace throng;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    if (size < sizeof(file::Header)) return 0;
    std::vector<std::byte> bytes(size);
    std::memcpy(bytes.data(), data, size);
    file::Header header;
    std::memcpy(&header, bytes.data(), sizeof header);
    header.size_bytes = size;
    std::memcpy(bytes.data(), &header, sizeof header);
    header.checksum = checksum_of(bytes);
    std::memcpy(bytes.data(), &header, sizeof header);
    const Result<Character> character = load_compiled_character(bytes, "fuzz.throng");
    if (character)
        fuzz::animate_and_draw(*character);
    else
        fuzz::check_refusal(character.error(), "fuzz.throng");
    return 0;
}
