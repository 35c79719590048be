// Updates and draws a crowd on a device, and prints what kind it is, whether the crowd moves, whether the picture shows
// it, and whether the process has loaded Vulkan.
//   without_vulkan creature.glb [DeviceSettings::select]
#include <throng/throng.h>

#include <cstdio>
#include <fstream>
#include <string>

using namespace throng;

namespace {

template <class T>
T need(Result<T> result) {
    if (!result) {
        std::fprintf(stderr, "%s\n", result.error().text().c_str());
        std::exit(1);
    }
    if constexpr (!std::is_void_v<T>) return *std::move(result);
}

bool has_loaded(const std::string& library) {
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);)
        if (line.find(library) != std::string::npos) return true;
    return false;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return 2;
    const Character character = need(load_character(argv[1]));
    const Device device = need(Device::create({.select = argc > 2 ? argv[2] : ""}));
    Crowd crowd = need(Crowd::create(device, {.groups = {{&character, 3}}}));
    const Playback playback{.first = {.clip = 0}};
    need(crowd.set_playback(InstanceHandle{1}, playback));
    need(crowd.update(0));
    const std::vector<Affine> before = need(crowd.read_skin_matrices({1}));
    need(crowd.update(0.2f));
    Renderer renderer = need(Renderer::create(device, {.width = 64, .height = 48}));
    const Camera camera = fit_camera(world_bounds(crowd), 4.0f / 3);
    const Picture all = need(renderer.render(crowd, camera)).picture,
                  none = need(renderer.render(crowd, {.eye = camera.target, .target = camera.eye})).picture;
    std::printf("%s, %s, %s, %s\n", device.info().type.c_str(),
                need(crowd.read_skin_matrices({1})) != before ? "moves" : "stands still",
                all.rgba != none.rgba ? "is seen" : "is not seen", has_loaded("libvulkan.so") ? "Vulkan" : "no Vulkan");
}
