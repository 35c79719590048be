#version 460
// Every struct that C++ and the shaders share, each in a buffer of its own: gpu_test reads from this module, compiled without
// optimisation, where the members lie, and compares with offsetof. Keep in step with src/*/*_io.h; the test says what is missing.
#include "bind/bind_io.h"
#include "blend/blend_io.h"
#include "control/control_io.h"
#include "draw/draw_io.h"
#include "fused/fused_io.h"
#include "gpu/affine.glsl"
#include "sample/sample_io.h"
#include "scan/scan_io.h"
#include "skin/skin_io.h"

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

layout(local_size_x = 1) in;
void main() {}
