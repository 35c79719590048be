// libFuzzer entry: any bytes as a PNG, JPEG or WebP image of a material.
#include "base/failure.h"
#include "draw/image_file.h"
#include "tests/fuzz/fuzz_crowd.h"

using namespace throng;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const auto bytes = fuzz::bytes_of(data, size);
    const AssetImage image{.name = "fuzz", .encoded = {bytes.begin(), bytes.end()}};
    constexpr uint64_t kMaxPixels = 1 << 22;  // so that an input takes little time
    const auto decoded = as_result([&] {
        const ImageFile file(image);
        if (uint64_t{file.width()} * file.height() <= kMaxPixels) (void)file.decode();
    });
    if (!decoded) fuzz::check_refusal(decoded.error(), "image 'fuzz'");
    return 0;
}
