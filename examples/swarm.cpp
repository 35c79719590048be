// Characters whose births, deaths, paths and clips are decided by a compute shader (swarm.comp): the CPU says nothing
// about any of them, and uploads nothing.
//   swarm character.glb picture.png
#include "open_vulkan.h"
#include "pipeline.h"

#include <throng/throng.h>

using namespace throng;

namespace {

constexpr uint32_t kShader[] = {
#include "swarm.comp.inc"
};
constexpr uint32_t kCount = 600, kFrames = 240;
constexpr float kStep_s = 1.0f / 30;

struct Push {
    uint32_t count, clip_count;
    float time_s, time_step_s, size;
};

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: swarm character.glb picture.png\n");
        return 2;
    }
    Cleanup cleanup;  // first, so that Vulkan outlives all that throng has made with it
    const AdoptedDevice vulkan = open_vulkan(cleanup, "swarm");
    const Context context{vulkan.physical_device, vulkan.device, cleanup};
    const Pipeline pipeline = make_compute_pipeline(context, kShader, 1, sizeof(Push));

    const Character character = load_character(argv[1]).expect();
    const Device device = Device::adopt(vulkan).expect();
    const CrowdGroup group{.character = &character,
                           .capacity = kCount,
                           .shader_commands = ShaderCommands{.capacity = 3 * kCount, .populate = true}};
    Crowd crowd = Crowd::create(device, {.groups = {group}}).expect();
    Renderer renderer = Renderer::create(device, {.width = 960, .height = 540}).expect();

    uint64_t drawn = 0;
    for (uint32_t frame = 0; frame < kFrames; ++frame) {
        const VkCommandBuffer commands = begin_commands(context, vulkan.queue_family);
        // Without this the buffer of commands would not be empty before the first update.
        if (frame == 0) crowd.record_uploads(commands).expect();
        const Push push{kCount, static_cast<uint32_t>(character.clips.size()), static_cast<float>(frame) * kStep_s,
                        kStep_s, character.size};
        bind(context, commands, pipeline, {crowd.outputs()[0].command});
        vkCmdPushConstants(commands, pipeline.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
        vkCmdDispatch(commands, (kCount + 63) / 64, 1, 1);
        // record() waits for what earlier shaders have written.
        crowd.record(commands, kStep_s).expect();
        submit_and_wait(vulkan.queue, commands);
        drawn += crowd.read_drawn().expect().size();
    }
    const Camera camera{.eye = Vec3<float>{0, 3, 7} * character.size, .target = {0, character.size / 2, 0}};
    write_png(argv[2], renderer.render(crowd, camera).expect().picture).expect();
    std::printf("%s: %.0f of %u were alive on average, on %s\n", argv[2], static_cast<double>(drawn) / kFrames, kCount,
                device.info().name.c_str());
    return drawn > uint64_t{kFrames} * kCount / 2 && drawn < uint64_t{kFrames} * kCount ? 0 : 1;
}
