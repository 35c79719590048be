// skeleton: a line from each joint of an instance to its parent, in the colour of the joint's level.
#include "cull/cull_io.h"
#include "draw/scene.glsl"
#include "gpu/affine.glsl"

CONSTANT(0, bool, kListed, false);

READONLY_BUFFER(kJointLevelsBuffer, JointLevel, joints);
READONLY_BUFFER(kModelBuffer, Affine, model_from_joint);
READONLY_BUFFER(kPlacementsBuffer, Affine, world_from_model);
READONLY_BUFFER(kListBuffer, uint, list);  // cull/cull_io.h
PUSH(LinePush);

layout(location = 0) flat out vec3 out_color;

#include "draw/line.glsl"

void main() {
    const bool drawn = !kListed || gl_InstanceIndex < list[kListCount];
    const uint instance = kListed ? list[kFirstListed + gl_InstanceIndex] : gl_InstanceIndex;
    const uint joint = gl_VertexIndex / kLineVertices, first = instance * push.joint_count;
    const bool has_parent = joints[joint].parent < joint;
    const uint parent = has_parent ? joints[joint].parent : joint;
    const WorldLine line = bone_line(world_from_model[instance], model_from_joint[first + joint],
                                     model_from_joint[first + parent], joints[joint].level, push.level_count);
    const vec4 point = line_corner(line, line_corner_of(gl_VertexIndex % kLineVertices));
    gl_Position = drawn && has_parent ? point : vec4(2, 2, 0, 1);
    out_color = line.color;
}
