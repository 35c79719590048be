#include <throng/throng.h>
#include <cstdlib>
#include <iostream>
using namespace throng;

// The value of a result, or one line on stderr and the end.
template <class T>
T need(Result<T> result) {
    if (!result) {
        std::cerr << result.error().text() << "\n";
        std::exit(1);
    }
    if constexpr (!std::is_void_v<T>) return *std::move(result);
}

int main(int, char** argv) {
    const Character character = need(load_character(argv[1]));
    const Device device = need(Device::create());
    Crowd crowd = need(Crowd::create(device, {.groups = {{&character, 1000}}}));
    for (uint32_t i = 0; i < crowd.instance_count(); ++i) {
        const Playback playback{.first = {.clip = 0, .time_s = 0.1 * i}};
        const Affine place = to_affine(
            Trs<float>{.translation = Vec3<float>{float(i % 40), 0, float(i / 40)} * character.size});
        need(crowd.set_playback(InstanceHandle{i}, playback));
        need(crowd.set_placement(InstanceHandle{i}, place));
    }
    for (int frame = 0; frame < 60; ++frame) need(crowd.update(1.0f / 60));
    Renderer renderer = need(Renderer::create(device));
    need(write_png(argv[2], need(renderer.render(crowd, fit_camera(world_bounds(crowd), 16.0f / 9))).picture));
}
