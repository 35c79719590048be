// What an update writes, where the application reads it on the GPU.
#pragma once

#include <throng/commands.h>
#include <throng/device.h>
#include <throng/look.h>
#include <throng/transform.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace throng {

// A vertex in OutputBlock::skinned.
struct SkinnedVertex {
    Vec3<float> position{};
    uint32_t normal_octahedral = 0;  // unit length; encoded as Vertex::normal_octahedral
};

// An entry of OutputBlock::root.
struct RootMotion {
    std::array<float, 4> move{};  // as described at OutputBlock::root
    std::array<std::array<float, 4>, 4> internal{};
};

// A morph that an instance shows.
struct ShownMorph {
    uint32_t morph = 0;
    float weight = 0;
};

// A range of a buffer that holds consecutive entries: in an OutputBlock, those of consecutive instances. There is none
// if `buffer` is VK_NULL_HANDLE.
struct BufferView {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize offset_bytes = 0;
    VkDeviceSize size_bytes = 0;
    VkDeviceSize stride_bytes = 0;  // from one entry to the next

    explicit operator bool() const { return buffer != VK_NULL_HANDLE; }
};

// The buffers of an OutputBlock on a native device, in host memory and with the same shapes; empty on other devices.
// The application may write the spans that are not const between two updates.
struct HostOutputs {
    std::span<const std::byte> skin{}, previous_skin{};
    std::span<const Affine> model{}, placement{}, socket{};
    std::span<float> parameter{};
    std::span<const RootMotion> root{};
    std::span<std::array<float, 4>> target{}, destination{};
    std::span<const ShownMorph> morph{};
    std::span<const InstanceLook> look{};
    std::span<CommandHead> command_head{};  // one element
    std::span<InstanceCommand> command{};
    std::span<const uint32_t> list{}, skin_row{};
    std::span<const SkinnedVertex> skinned{};
};

// Results of consecutive instances of one group. The views stay the same as long as the group is in the crowd, and
// those that the crowd does not have are empty. Each can be bound as storage buffer or vertex buffer and copied from;
// `draw` is for indirect draws too. (For another usage, such as building acceleration structures, copy them first.)
// Offsets are multiples of all alignments that the device asks for.
//
// They are written by compute shaders, and made visible by record() to later compute, vertex, indirect and transfer
// reads on the same queue. They are valid from when the recorded commands have run until those of a later record() to
// the same frame slot run:
// - With one slot (CrowdSettings::frames_in_flight), that is the next record(). Its commands wait for what reads the
//   results in compute and vertex shaders, indirect draws and transfers. For other stages, such as fragment shaders,
//   the application puts a barrier before it.
// - With several slots it is the record() that many later. The application has to make sure that the reading has
//   finished by then. What the application itself writes (parameter, target, destination, command) is the same in all
//   slots, and must not be read by drawing.
//
// In crowds that cull (CrowdSettings::culling), and without a skin pool, instances that are not listed keep the
// matrices of the last update that listed them. An instance that is listed, but was not in the update before, has no
// previous matrices: the update writes its current ones into previous_skin, which is `skin` of the slot before. Frames
// in flight that read that slot do not draw the instance.
struct OutputBlock {
    GroupIndex group = 0;
    uint32_t first_instance = 0;  // of the crowd
    uint32_t instance_count = 0;
    uint32_t palette_count = 0;
    uint32_t joint_count = 0;

    // Skin matrices, [instance_count][palette_count] in CrowdSettings::skin_format, model space: skinned position =
    // matrix * bind position. With CrowdGroup::skin_pool [skin_row_count][palette_count].
    BufferView skin{};
    // Skin matrices of the update before, in model space, with CrowdSettings::keep_previous_matrices. Where instances
    // stood then is in `placement` of the slot before, if frames_in_flight is 2 or more (otherwise all slots share one
    // buffer of placements). For an instance that has been spawned since, that is the placement of the previous
    // instance with its number.
    BufferView previous_skin{};
    uint32_t skin_row_count = 0;  // instance_count or, with a pool, its rows: shared poses, then instances' own
    // With a skin pool: which row of `skin` an instance has, uint32_t[instance_count]. Only instances that are listed
    // have one.
    BufferView skin_row{};
    // model_from_joint, Affine[instance_count][joint_count], with CrowdSettings::keep_model_matrices.
    BufferView model{};
    // world_from_model, Affine[instance_count].
    BufferView placement{};

    uint32_t socket_count = 0;
    // Transforms of CrowdGroup::sockets, Affine[instance_count][socket_count] in CrowdGroup::socket_space.
    BufferView socket{};

    uint32_t parameter_count = 0;
    // Parameters of the controller, float[instance_count][parameter_count]. Between two updates the application's own
    // shaders or copies may write it. The same in all frame slots. The update that spawns an instance sets its
    // parameters to the initial ones of the controller: what is written for it before has no effect.
    BufferView parameter{};
    // Root motion of a group with a controller, float4[instance_count][5]. The first float4 is the last update's move
    // over the ground: x, z, then cosine and sine of the turn about +y, in the character's space before the move. The
    // others are internal.
    BufferView root{};

    uint32_t target_count = 0;
    // Targets of procedural rules, float4[instance_count][target_count]: a place in world space, and its weight in w.
    // May be written like the parameters, and is the same in all frame slots too. The update that spawns an instance
    // clears its targets, so one that a shader writes for it has an effect only from the next update on.
    BufferView target{};
    // Destinations of agents, float4[instance_count]: a place in world space, and in w whether the agent has one (1 or
    // 0). The same applies as for targets.
    BufferView destination{};

    uint32_t morph_count = 0;  // that an instance may show: all of the character, or CrowdGroup::morph_limit
    // Morphs that each instance shows, ShownMorph[instance_count][morph_count]: those that have weight, then entries of
    // weight 0. They are in the order of Character::morphs or, with a limit below the number of morphs, the largest
    // weight by magnitude first. To be applied before skinning: bind position += weight * MorphDelta.
    BufferView morph{};

    // How instances look, InstanceLook[instance_count], with CrowdGroup::outfits.
    BufferView look{};

    uint32_t command_capacity = 0;  // ShaderCommands::capacity
    // Commands of the application's own shaders for instances of the block: a CommandHead, then
    // InstanceCommand[command_capacity]. The same in all frame slots. Write it between two updates, or before the first
    // one, after Crowd::record_uploads(), which uploads the empty buffer. In that case do not save, restore, read, draw
    // or discard before the update that executes the commands, since that may upload the empty buffer again.
    BufferView command{};

    // Instances that are drawn, uint32_t[5 + instance_count], in crowds that cull. The first word is how many
    // there are. The next four say for each level of detail where its instances begin, counted from the sixth word.
    // From the sixth word on come the instances, as indices in the block: level by level, ascending within each.
    BufferView list{};
    // Draw calls for Crowd::mesh(), VkDrawIndexedIndirectCommand[section_count][4 levels of detail], in
    // crowds that cull; the n-th instance of a call is the n-th of its level in the list. The stride is that of a
    // command.
    BufferView draw{};
    // Where the call of a section in a level of detail begins in draw.buffer.
    VkDeviceSize draw_offset_bytes(uint32_t section, uint32_t lod) const {
        constexpr uint32_t kLods = 4;
        return draw.offset_bytes + (VkDeviceSize{section} * kLods + lod) * draw.stride_bytes;
    }

    uint32_t vertex_count = 0;
    // Morphed and skinned vertices, SkinnedVertex[instance_count][vertex_count], model space, in the order of
    // Character::vertices, with CrowdSettings::skins_once: those of level of detail 0 or, where the crowd culls, of the
    // listed instances and their levels. Others are not written.
    BufferView skinned{};

    // On a native device, in place of the buffers.
    HostOutputs host{};
};

}  // namespace throng
