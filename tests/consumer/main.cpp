#include <throng/throng.h>

#include <cstdio>

#if defined(NEEDS_HEADERS_OF_SDK) && !defined(HEADERS_OF_SDK)
#error "these are not the Vulkan headers of the SDK"
#endif

namespace {

throng::Result<void> animate(const char* file) {
    const throng::Result<throng::Character> character = throng::load_character(file);
    if (!character) return character.error();
    std::printf("%u joints\n", character->rig.joint_count());
    const throng::Result<throng::Device> device = throng::Device::create();
    if (!device) return device.error();
    throng::Result<throng::Crowd> crowd = throng::Crowd::create(*device, {.groups = {{&*character, 10}}});
    if (!crowd) return crowd.error();
    return crowd->update(1.0f / 60);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const throng::Result<void> done = animate(argv[1]);
    if (!done) std::fprintf(stderr, "%s\n", done.error().text().c_str());
    return done ? 0 : 1;
}
