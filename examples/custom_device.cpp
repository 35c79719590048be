// An application that has its own Vulkan and its own renderer, and takes only the animation from throng: throng records
// the update into the application's command buffer, and the application's vertex shader reads the matrices where throng
// left them. The update is for a camera: it animates and lists only what the camera sees, and writes the draw commands.
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
constexpr VkFormat kColorFormat = VK_FORMAT_R8G8B8A8_SRGB, kDepthFormat = VK_FORMAT_D32_SFLOAT;

constexpr uint32_t kAcross = 20;  // characters on each side of a square

struct Push {
    std::array<std::array<float, 4>, 4> clip_from_world;  // rows
    std::array<float, 4> base_color;
    uint32_t first_vertex, first_influences, influence_sets, palette_count, lod;
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
    const Pipeline pipeline = make_pipeline(
        context, {kVertexShader, kFragmentShader, 5, sizeof(Push), kColorFormat, kDepthFormat, kSize});

    // A square of one character, each at another time of another clip.
    const Character character = load_character(argv[1]).expect();
    const Device device = Device::adopt(vulkan).expect();
    Crowd crowd = Crowd::create(device, {.groups = {{&character, kAcross * kAcross}}, .culling = Culling{}}).expect();
    for (uint32_t i = 0; i < crowd.instance_count(); ++i) {
        const ClipPlayback clip{
            .clip = character.clips.empty() ? kNone : i % static_cast<uint32_t>(character.clips.size()),
            .time_s = 0.3 * i};
        const Playback playback{.first = clip};
        const auto x = static_cast<float>(i % kAcross), z = static_cast<float>(i / kAcross);
        const Affine place = to_affine(Trs<float>{.translation = Vec3<float>{x, 0, z} * (character.size * 0.6f)});
        crowd.set_playback(InstanceHandle{i}, playback).expect();
        crowd.set_placement(InstanceHandle{i}, place).expect();
    }

    // From the middle, so that most are behind the camera or beside it.
    const Target target = make_target(context, kSize, kColorFormat, kDepthFormat);
    const Bounds bounds = main_bounds(crowd);
    const Vec3<float> middle = (bounds.min + bounds.max) * 0.5f;
    const Camera camera{.eye = {middle.x, bounds.max.y * 1.5f, middle.z}, .target = {middle.x, middle.y, bounds.min.z}};
    const CrowdView view = view_of(camera, kSize.width, kSize.height, bounds).expect();

    // One command buffer: throng's update, then the application's drawing. record() has made its results visible to
    // vertex shaders and indirect draws.
    const VkCommandBuffer commands = begin_commands(context, vulkan.queue_family);
    crowd.record(commands, 0.5f, &view).expect();
    begin_drawing(commands, target);
    const GroupMesh mesh = crowd.mesh(0).expect();
    vkCmdBindIndexBuffer(commands, mesh.index.buffer, mesh.index.offset_bytes, VK_INDEX_TYPE_UINT32);
    for (const OutputBlock& block : crowd.outputs()) {  // a large crowd's matrices lie in several buffers
        bind(context, commands, pipeline, {mesh.vertex, mesh.influences, block.skin, block.placement, block.list});
        for (uint32_t s = 0; s < character.sections.size(); ++s)
            for (uint32_t lod = 0; lod < mesh.lod_count; ++lod) {
                const MeshSection& section = character.sections[s];
                const Push push{view.clip_from_world,
                                section.material == kNone ? std::array<float, 4>{1, 1, 1, 1}
                                                          : character.materials[section.material].base_color,
                                section.first_vertex,
                                mesh.section_lods[s * mesh.lod_count + lod].first_influences,
                                section.influence_sets,
                                block.palette_count,
                                lod};
                vkCmdPushConstants(commands, pipeline.layout, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof push, &push);
                vkCmdDrawIndexedIndirect(commands, block.draw.buffer, block.draw_offset_bytes(s, lod), 1, 0);
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
    std::printf("%s: %zu of %u of %s on %s, %zu pixels\n", argv[2], crowd.read_drawn().expect().size(),
                crowd.instance_count(), character.name.c_str(), device.info().name.c_str(), drawn);
    return drawn > picture.rgba.size() / 4 / 50 ? 0 : 1;  // at least 2 % of the picture
}
