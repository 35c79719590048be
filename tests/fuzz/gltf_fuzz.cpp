// libFuzzer entry: any bytes as a glTF file, from the import to a picture of a crowd. Side files cannot be found.
#include "tests/fuzz/fuzz_crowd.h"

using namespace throng;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const Result<Asset> asset = load_asset(fuzz::bytes_of(data, size), "fuzz.glb");
    if (!asset) {
        fuzz::check_refusal(asset.error(), "fuzz.glb");
        return 0;
    }
    const Result<Character> character = compile_character(*asset);
    if (character)
        fuzz::animate_and_draw(*character);
    else
        fuzz::check_refusal(character.error(), "fuzz.glb");
    return 0;
}
