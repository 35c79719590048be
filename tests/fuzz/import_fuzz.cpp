// libFuzzer entry: any bytes as a glTF file. Built with -fsanitize=fuzzer,address,undefined; side files cannot be
// found.
#include "base/failure.h"
#include "import/read_asset.h"

#include <cstdint>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
    const auto result = throng::as_result(
        [&] { return throng::gltf::read_asset(bytes, "fuzz.glb", std::filesystem::path("/nowhere")); }, "fuzz.glb");
    // Whatever is refused is refused with one line that begins with the file's name.
    if (!result.ok()) {
        const std::string text = result.error().text();
        if (!text.starts_with("fuzz.glb: ") || text.find_first_of("\r\n") != text.npos) std::abort();
    }
    return 0;
}
