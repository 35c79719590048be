// libFuzzer entry: any text as a controller, which then drives a crowd.
#include "tests/fuzz/fuzz_crowd.h"

#include <algorithm>

using namespace throng;

namespace {

// Sets every parameter to 0, to 1 and to values in between, while time goes on, stands and goes back.
void drive(Crowd& crowd, const Controller& controller) {
    const Instances all = Instances::numbered(0, 3);
    for (uint32_t update = 0; update < 12; ++update) {
        for (uint32_t parameter = 0; parameter < controller.parameters.size(); ++parameter)
            (void)crowd.set_parameter(all, parameter, static_cast<float>((update + parameter) % 5) * 0.5f);
        for (uint32_t layer = 0; layer < controller.layers.size(); ++layer) {
            if (controller.layers[layer].states.empty() && update % 4 == 1)
                (void)crowd.play(all, layer, LayerPlayback{.clip = {.clip = update % 3}, .fade_s = 0.2f});
            if (update % 6 == 3) (void)crowd.set_layer(all, layer, LayerBlend{.weight = 0.7f, .fade_s = 0.1f});
        }
        (void)crowd.update(update % 7 == 5 ? -0.3f : 0.15f * static_cast<float>(update % 3));
        (void)crowd.feedback();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const Result<Controller> controller = parse_controller({reinterpret_cast<const char*>(data), size}, "fuzz.json");
    if (!controller) {
        fuzz::check_refusal(controller.error(), "fuzz.json");
        return 0;
    }
    const Character& character = fuzz::small_walker();
    const Result<void> fits = check_controller(*controller, character);
    CrowdSettings settings{
        .groups = {{.character = &character, .instance_count = 3, .controller = &*controller, .sockets = {1}}}};
    settings.event_capacity = 64;
    Result<Crowd> crowd = Crowd::create(fuzz::device(), settings);
    if (!fits && crowd) std::abort();
    if (!crowd) return 0;
    (void)crowd->watch(Instances::numbered(0, 3));
    drive(*crowd, *controller);
    return 0;
}
