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

// From red at the root by yellow, green and blue to violet at the last level.
vec3 level_color(uint level) {
    const float hue = 0.8 * float(level) / max(push.level_count - 1, 1);
    return clamp(abs(fract(hue + vec3(0, 2, 1) / 3.0) * 6 - 3) - 1, 0, 1);
}

void main() {
    const bool drawn = !kListed || gl_InstanceIndex < list[kListCount];
    const uint instance = kListed ? list[kFirstListed + gl_InstanceIndex] : gl_InstanceIndex;
    const uint joint = gl_VertexIndex / kLineVertices, first = instance * push.joint_count;
    const bool has_parent = joints[joint].parent < joint;
    const uint parent = has_parent ? joints[joint].parent : joint;
    const Affine from = model_from_joint[first + joint], to = model_from_joint[first + parent],
                 place = world_from_model[instance];
    const vec3 from_model = vec3(from.row0.w, from.row1.w, from.row2.w),
               to_model = vec3(to.row0.w, to.row1.w, to.row2.w);
    const vec4 point = line_vertex(to_clip(affine_point(place, from_model)), to_clip(affine_point(place, to_model)),
                                   gl_VertexIndex % kLineVertices, 0.012 * scene.ground.w);
    gl_Position = drawn && has_parent ? point : vec4(2, 2, 0, 1);
    out_color = level_color(joints[joint].level);
}
