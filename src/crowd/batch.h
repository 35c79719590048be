// A run of a group's instances whose buffers fit the device's limits.
#pragma once

#include "gpu/kernel.h"

namespace throng {

struct Batch {
    uint32_t group = 0;
    uint32_t first_instance = 0, instance_count = 0;
    uint32_t blending_count = 0;  // instances in which both clips have weight, as last set
    bool blends = false;          // whether there are any in the update that is under way
    Buffer placements;
    Buffer playbacks, cursors;  // two clips an instance
    // Layers, where the group has a controller; roots where it has root motion
    Buffer layers, parameters, voices, roots;
    std::array<Buffer, 2> skins;  // the second only where CrowdSettings::keep_previous_matrices; then they take turns
    uint32_t current_skin = 0;    // written by the last update
    Buffer kept_model;            // where CrowdSettings::keep_model_matrices
    Buffer inertias, inertia_states;  // where the controller has inertial transitions
    // Where layers blend rotations in model space: io::ModelRotations[such layers][joint_count][instance_count]
    Buffer rotations;
    // Where the character has morphs: of voices, where it has a controller too;
    // io::ActiveMorph[instance_count][kActiveMorphs]
    Buffer voice_times, morphs;
    Buffer sockets;               // Affine[instance_count][socket_count]
    Buffer targets, springs;      // where the group has procedural rules
    Buffer destinations, agents;  // where the group steers: float4[instance_count], io::AgentState[instance_count]
    Buffer posed;  // where the group has room for poses: io::InstancePose[instance_count], a table of words
    // Where CrowdSettings::culls (cull/cull_io.h): what is drawn and what is animated, tables of words; what is kept of
    // each instance; what animates it and what draws it, VkDispatchIndirectCommand[kWorkSections + 1], the last one of
    // skinning what is drawn, and io::DrawCommand[section_count][kDetailLevels].
    Buffer list, work, states, dispatches, draws;
    Buffer skinned;  // where CrowdSettings::skins_once: SkinnedVertex[instance_count][vertex_count]
    Buffer ahead;    // where CrowdSettings::skips_updates: skin matrices that instances go on towards
    Bindings control;

    const Buffer& skin() const { return skins[current_skin]; }
};

}  // namespace throng
