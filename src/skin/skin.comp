#version 460
// skin: positions of one instance's vertices in model space, for those who read them back; the draw skins in its vertex shader.
// One invocation per vertex.
#include "skin/skin_io.h"
#include "bind/bind_io.h"
#include "morph/morph_io.h"

layout(local_size_x = kSkinWorkgroupSize) in;
layout(set = 0, binding = 0, std430) readonly buffer Vertices { VertexRows vertices[]; };
layout(set = 0, binding = 1, std430) readonly buffer InfluenceWords { uvec2 influences[]; };
layout(set = 0, binding = 3, std430) writeonly buffer Positions { vec4 positions[]; };
layout(set = 0, binding = 4, std430) readonly buffer MorphDeltas { uvec4 morph_deltas[]; };
layout(set = 0, binding = 5, std430) readonly buffer ActiveMorphs { ActiveMorph active_morphs[]; };
layout(push_constant) uniform Push { SkinPush push; };

layout(constant_id = 1) const uint kSkinFormat = kSkinAffine;
#define SKIN_SET 0
#define SKIN_BINDING 2
#include "bind/skin_format.glsl"
#include "skin/skin.glsl"
#include "morph/apply.glsl"

void main() {
    const uint vertex = gl_GlobalInvocationID.x;
    if (vertex >= push.vertex_count) return;
    const Affine model_from_bind = blended_skin_matrix(push.first_influences, push.influence_sets, vertex, push.first_palette_entry);
    const VertexRows rows = vertices[push.first_vertex + vertex];
    const vec3 position = rows.position_normal.xyz + sum_of_morphs(rows.texcoord_color_delta.w, push.first_morph, push.morph_count, push.first_active).position;
    positions[push.first_vertex + vertex] = vec4(affine_point(model_from_bind, position), 1);
}
