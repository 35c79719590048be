// bounds: the edges of the box against which culling tests an instance.
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
    const WorldLine edge = box_edge(world_from_model[instance], push.box_centre.xyz, push.box_half_extent.xyz,
                                    gl_VertexIndex / kLineVertices);
    gl_Position = drawn ? line_corner(edge, line_corner_of(gl_VertexIndex % kLineVertices)) : vec4(2, 2, 0, 1);
    out_color = edge.color;
}
