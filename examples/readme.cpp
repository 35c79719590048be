#include <throng/throng.h>
using namespace throng;

int main(int, char** argv) {
    const Character character = load_character(argv[1]).expect();
    const Device device = Device::create().expect();
    Crowd crowd = Crowd::create(device, {.groups = {{&character, 1000}}}).expect();
    for (uint32_t i = 0; i < crowd.instance_count(); ++i) {
        const Playback playback{.first = {.clip = 0, .time_s = 0.1 * i}};
        const Affine place = to_affine(
            Trs<float>{.translation = Vec3<float>{float(i % 40), 0, float(i / 40)} * character.size});
        crowd.set_playback(InstanceHandle{i}, playback).expect();
        crowd.set_placement(InstanceHandle{i}, place).expect();
    }
    for (int frame = 0; frame < 60; ++frame) crowd.update(1.0f / 60).expect();
    Renderer renderer = Renderer::create(device).expect();
    write_png(argv[2], renderer.render(crowd, fit_camera(main_bounds(crowd), 16.0f / 9)).expect().picture).expect();
}
