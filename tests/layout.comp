#version 460
// Every struct that C++ and the shaders share, each in a buffer of its own: gpu_test reads from this module, compiled
// without optimisation, where the members lie, and compares with offsetof. Keep in step with src/*/*_io.h; the test
// says what is missing.
#include "bind/bind_io.h"
#include "bind/sockets_io.h"
#include "blend/blend_io.h"
#include "blend/inertia_io.h"
#include "blend/layered_io.h"
#include "blend/posed_io.h"
#include "control/control_io.h"
#include "control/controller_io.h"
#include "cull/cull_io.h"
#include "pace/pace_io.h"
#include "draw/draw_io.h"
#include "fused/fused_io.h"
#include "gpu/affine.glsl"
#include "morph/morph_io.h"
#include "procedural/procedural_io.h"
#include "sample/sample_io.h"
#include "scan/scan_io.h"
#include "skin/skin_io.h"
#include "steer/steer_io.h"

layout(set = 0, binding = 0, std430) buffer Buffer0 { SlotPlayback slot_playbacks[]; };
layout(set = 0, binding = 1, std430) buffer Buffer1 { InstancePlayback instance_playbacks[]; };
layout(set = 0, binding = 2, std430) buffer Buffer2 { ClipAxis clip_axes[]; };
layout(set = 0, binding = 3, std430) buffer Buffer3 { SlotCursor slot_cursors[]; };
layout(set = 0, binding = 4, std430) buffer Buffer4 { InstanceCursor instance_cursors[]; };
layout(set = 0, binding = 5, std430) buffer Buffer5 { ControlPush control_pushes[]; };
layout(set = 0, binding = 6, std430) buffer Buffer6 { JointPose joint_poses[]; };
layout(set = 0, binding = 7, std430) buffer Buffer7 { SamplePush sample_pushes[]; };
layout(set = 0, binding = 8, std430) buffer Buffer8 { BlendPush blend_pushes[]; };
layout(set = 0, binding = 9, std430) buffer Buffer9 { ScanPush scan_pushes[]; };
layout(set = 0, binding = 10, std430) buffer Buffer10 { BindPush bind_pushes[]; };
layout(set = 0, binding = 11, std430) buffer Buffer11 { VertexRows vertex_rows[]; };
layout(set = 0, binding = 12, std430) buffer Buffer12 { SkinPush skin_pushes[]; };
layout(set = 0, binding = 13, std430) buffer Buffer13 { DrawScene draw_scenes[]; };
layout(set = 0, binding = 14, std430) buffer Buffer14 { DrawPush draw_pushes[]; };
layout(set = 0, binding = 15, std430) buffer Buffer15 { Affine affines[]; };
layout(set = 0, binding = 16, std430) buffer Buffer16 { FusedPush fused_pushes[]; };
layout(set = 0, binding = 17, std430) buffer Buffer17 { LayeredPush layered_pushes[]; };
layout(set = 0, binding = 18, std430) buffer Buffer18 { InertiaJoint inertia_joints[]; };
layout(set = 0, binding = 19, std430) buffer Buffer19 { ControlClip control_clips[]; };
layout(set = 0, binding = 20, std430) buffer Buffer20 { ControlLayer control_layers[]; };
layout(set = 0, binding = 21, std430) buffer Buffer21 { ControlState control_states[]; };
layout(set = 0, binding = 22, std430) buffer Buffer22 { ControlPoint control_points[]; };
layout(set = 0, binding = 23, std430) buffer Buffer23 { ControlTriangle control_triangles[]; };
layout(set = 0, binding = 24, std430) buffer Buffer24 { ControlEdge control_edges[]; };
layout(set = 0, binding = 25, std430) buffer Buffer25 { ControlTransition control_transitions[]; };
layout(set = 0, binding = 26, std430) buffer Buffer26 { ControlCondition control_conditions[]; };
layout(set = 0, binding = 27, std430) buffer Buffer27 { ControlEvent control_events[]; };
layout(set = 0, binding = 28, std430) buffer Buffer28 { ControllerLayout controller_layouts[]; };
layout(set = 0, binding = 29, std430) buffer Buffer29 { LayerPlay layer_plays[]; };
layout(set = 0, binding = 30, std430) buffer Buffer30 { LayerState layer_states[]; };
layout(set = 0, binding = 31, std430) buffer Buffer31 { Voice voices[]; };
layout(set = 0, binding = 32, std430) buffer Buffer32 { InstanceInertia instance_inertias[]; };
layout(set = 0, binding = 33, std430) buffer Buffer33 { RootState root_states[]; };
layout(set = 0, binding = 34, std430) buffer Buffer34 { EventHead event_heads[]; };
layout(set = 0, binding = 35, std430) buffer Buffer35 { EventRecord event_records[]; };
layout(set = 0, binding = 36, std430) buffer Buffer36 { ControlCommand control_commands[]; };
layout(set = 0, binding = 37, std430) buffer Buffer37 { ControllerPush controller_pushs[]; };
layout(set = 0, binding = 38, std430) buffer Buffer38 { CommandPush command_pushs[]; };
layout(set = 0, binding = 39, std430) buffer Buffer39 { InertiaState inertia_states[]; };
layout(set = 0, binding = 40, std430) buffer Buffer40 { SocketPush socket_pushs[]; };
layout(set = 0, binding = 41, std430) buffer Buffer41 { ProceduralChain procedural_chains[]; };
layout(set = 0, binding = 42, std430) buffer Buffer42 { ProceduralJoint procedural_joints[]; };
layout(set = 0, binding = 43, std430) buffer Buffer43 { WindSettings wind_settings[]; };
layout(set = 0, binding = 44, std430) buffer Buffer44 { SpringSettings spring_settings[]; };
layout(set = 0, binding = 45, std430) buffer Buffer45 { ColliderShape collider_shapes[]; };
layout(set = 0, binding = 46, std430) buffer Buffer46 { LookAtSettings look_at_settings[]; };
layout(set = 0, binding = 47, std430) buffer Buffer47 { ReachSettings reach_settings[]; };
layout(set = 0, binding = 48, std430) buffer Buffer48 { SpringState spring_states[]; };
layout(set = 0, binding = 49, std430) buffer Buffer49 { ProceduralPush procedural_pushs[]; };
layout(set = 0, binding = 50, std430) buffer Buffer50 { InstancePose instance_poses[]; };
layout(set = 0, binding = 51, std430) buffer Buffer51 { LayeredInOrderPush layered_in_order_pushs[]; };
layout(set = 0, binding = 52, std430) buffer Buffer52 { ModelRotations model_rotations[]; };
layout(set = 0, binding = 53, std430) buffer Buffer53 { ActiveMorph active_morphs[]; };
layout(set = 0, binding = 54, std430) buffer Buffer54 { MorphPush morph_pushes[]; };
layout(set = 0, binding = 55, std430) buffer Buffer55 { CullView cull_views[]; };
layout(set = 0, binding = 56, std430) buffer Buffer56 { CullPush cull_pushs[]; };
layout(set = 0, binding = 57, std430) buffer Buffer57 { OffsetsPush offsets_pushs[]; };
layout(set = 0, binding = 58, std430) buffer Buffer58 { DrawCommand draw_commands[]; };
layout(set = 0, binding = 59, std430) buffer Buffer59 { RevealPush reveal_pushes[]; };
layout(set = 0, binding = 60, std430) buffer Buffer60 { PyramidPush pyramid_pushes[]; };
layout(set = 0, binding = 61, std430) buffer Buffer61 { PacePush pace_pushes[]; };
layout(set = 0, binding = 62, std430) buffer Buffer62 { LinePush line_pushes[]; };
layout(set = 0, binding = 67, std430) buffer Buffer67 { SkinSection skin_sections[]; };
layout(set = 0, binding = 63, std430) buffer Buffer63 { AgentPlace agent_places[]; };
layout(set = 0, binding = 64, std430) buffer Buffer64 { AgentState agent_states[]; };
layout(set = 0, binding = 65, std430) buffer Buffer65 { PlacesPush places_pushes[]; };
layout(set = 0, binding = 66, std430) buffer Buffer66 { SteerPush steer_pushes[]; };

layout(local_size_x = 1) in;
void main() {}
