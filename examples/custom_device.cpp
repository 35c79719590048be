// An application that has its own Vulkan and its own renderer, and takes only the animation from throng: throng records
// the update into the application's command buffer, and the application's vertex shader reads the matrices where throng
// left them.
//   custom_device character.glb picture.png
#include "open_vulkan.h"
#include "pipeline.h"

#include <throng/throng.h>

#include <algorithm>

using namespace throng;

namespace {

constexpr uint32_t kVertexShader[] = {
#include "custom_device.vert.inc"
};
constexpr uint32_t kFragmentShader[] = {
#include "custom_device.frag.inc"
};
constexpr VkExtent2D kSize{960, 540};
constexpr VkFormat kColorFormat = VK_FORMAT_R8G8B8A8_SRGB, kDepthFormat = VK_FORMAT_D16_UNORM;

struct Push {
    std::array<float, 16> clip_from_world;
    std::array<float, 4> base_color;
    uint32_t first_vertex, first_influences, influence_sets, palette_count;
};

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: custom_device character.glb picture.png\n");
        return 2;
    }
    Cleanup cleanup;  // first, so that Vulkan outlives all that throng has made with it
    const AdoptedDevice vulkan = open_vulkan(cleanup, "custom_device");
    const Context context{vulkan.physical_device, vulkan.device, cleanup};
    const GraphicsPipeline pipeline = make_pipeline(
        context, {kVertexShader, kFragmentShader, 4, sizeof(Push), kColorFormat, kDepthFormat, kSize});

    // Seven of one character in a row, each at another time of another clip.
    const Character character = load_character(argv[1]).expect();
    const Device device = Device::adopt(vulkan).expect();
    Crowd crowd = Crowd::create(device, {.groups = {{&character, 7}}}).expect();
    for (uint32_t i = 0; i < crowd.instance_count(); ++i) {
        const ClipPlayback clip{
            .clip = character.clips.empty() ? kNone : i % static_cast<uint32_t>(character.clips.size()),
            .time_s = 0.3 * i};
        const Playback playback{.first = clip};
        const Affine place = to_affine(
            Trs<float>{.translation = {static_cast<float>(i) * character.size * 0.6f, 0, 0}});
        crowd.set_playback(InstanceHandle{i}, playback).expect();
        crowd.set_placement(InstanceHandle{i}, place).expect();
    }

    // The mesh in the application's buffers. Character's arrays go to the GPU as they are.
    const auto upload = [&](const auto& array, VkBufferUsageFlags usage) {
        return make_buffer(context, array.size() * sizeof(array[0]), usage, array.data()).handle;
    };
    const VkBuffer vertices = upload(character.vertices, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT),
                   influences = upload(character.influences, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const VkBuffer indices = upload(character.indices, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    const Target target = make_target(context, kSize, kColorFormat, kDepthFormat);

    // One command buffer: throng's update, then the application's drawing. record() has made its results visible to
    // vertex shaders.
    const Camera camera = fit_camera(world_bounds(crowd), static_cast<float>(kSize.width) / kSize.height);
    const VkCommandBuffer commands = begin_commands(context, vulkan.queue_family);
    crowd.record(commands, 0.5f).expect();
    begin_drawing(commands, target);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.handle);
    vkCmdBindIndexBuffer(commands, indices, 0, VK_INDEX_TYPE_UINT32);
    for (const OutputBlock& block : crowd.outputs()) {  // a large crowd's matrices lie in several buffers
        bind_storage_buffers(context, commands, pipeline,
                             {vertices, influences, block.skin.buffer, block.placement.buffer});
        for (const MeshSection& section : character.sections) {
            const Push push{clip_from_world(camera, static_cast<float>(kSize.width) / kSize.height),
                            section.material == kNone ? std::array<float, 4>{1, 1, 1, 1}
                                                      : character.materials[section.material].base_color,
                            section.first_vertex,
                            section.first_influences,
                            section.influence_sets,
                            block.palette_count};
            vkCmdPushConstants(commands, pipeline.layout, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof push, &push);
            vkCmdDrawIndexed(commands, section.index_count, block.instance_count, section.first_index,
                             static_cast<int32_t>(section.first_vertex), 0);
        }
    }
    end_drawing(commands, target);
    submit_and_wait(vulkan.queue, commands);

    const auto* pixels = static_cast<const uint8_t*>(target.pixels.mapped);
    Picture picture{kSize.width, kSize.height, {pixels, pixels + size_t{kSize.width} * kSize.height * 4}};
    write_png(argv[2], picture).expect();
    size_t drawn = 0;
    for (size_t i = 0; i < picture.rgba.size(); i += 4)
        drawn += !std::equal(&picture.rgba[i], &picture.rgba[i] + 4, picture.rgba.data());
    std::printf("%s: %u of %s on %s, %zu pixels\n", argv[2], crowd.instance_count(), character.name.c_str(),
                device.info().name.c_str(), drawn);
    return drawn > picture.rgba.size() / 4 / 50 ? 0 : 1;  // at least 2 % of the picture
}
