// bounds: the edges of the box that culling tests of an instance.
#include "cull/cull_io.h"
#include "draw/scene.glsl"
#include "gpu/affine.glsl"

CONSTANT(0, bool, kListed, false);

READONLY_BUFFER(kPlacementsBuffer, Affine, world_from_model);
READONLY_BUFFER(kListBuffer, uint, list);  // cull/cull_io.h
PUSH(LinePush);

layout(location = 0) flat out vec3 out_color;

#include "draw/line.glsl"

void main() {
    const bool drawn = !kListed || gl_InstanceIndex < list[kListCount];
    const uint instance = kListed ? list[kFirstListed + gl_InstanceIndex] : gl_InstanceIndex;
    // Four edges along each axis, from its low side to its high one.
    const uint edge = gl_VertexIndex / kLineVertices, axis = edge / 4;
    vec3 low = vec3(-1);
    low[(axis + 1) % 3] = (edge & 1) == 0 ? -1 : 1;
    low[(axis + 2) % 3] = (edge & 2) == 0 ? -1 : 1;
    vec3 high = low;
    high[axis] = 1;
    const Affine place = world_from_model[instance];
    const vec4 from = to_clip(affine_point(place, push.box_centre.xyz + low * push.box_half_extent.xyz)),
               to = to_clip(affine_point(place, push.box_centre.xyz + high * push.box_half_extent.xyz));
    gl_Position = drawn ? line_vertex(from, to, gl_VertexIndex % kLineVertices, 0.006 * scene.ground.w)
                        : vec4(2, 2, 0, 1);
    out_color = vec3(1.0, 0.75, 0.1);
}
