#version 460
// Skins and places one vertex of one instance, from throng's mesh and matrices.

// throng::Vertex, 32 bytes, and throng::Influences, 24 bytes; the arrays keep their 4-byte alignment.
struct Vertex {
    float position[3];
    uint normal;
    float texcoord[2];
    uint color;
    uint unused;
};
struct Influences {
    float weights[4];
    uint entries[2];
};

layout(set = 0, binding = 0, std430) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 1, std430) readonly buffer InfluenceSets { Influences influences[]; };
// throng::OutputBlock: matrices of three rows each, skin [instance_count][palette_count], placement [instance_count].
layout(set = 0, binding = 2, std430) readonly buffer SkinMatrices { vec4 skin_rows[]; };
layout(set = 0, binding = 3, std430) readonly buffer Placements { vec4 placement_rows[]; };

// throng::OutputBlock::list, the instances that are drawn: how many; where each of four levels of detail begins after
// the fifth word; then their numbers.
layout(set = 0, binding = 4, std430) readonly buffer List { uint list[]; };

layout(push_constant) uniform Push {
    mat4 clip_from_world;  // stored by rows, so GLSL has its transpose: vector * matrix applies it
    vec4 base_color;
    uint first_vertex, first_influences, influence_sets, palette_count, lod;
};

layout(location = 0) out vec3 out_world;
layout(location = 1) out vec4 out_color;

// weight * matrix. The matrix's rows are the columns of the result, so vector * result applies it.
mat3x4 weighted_skin_matrix(uint instance, uint palette_entry, float weight) {
    const uint row = 3 * (instance * palette_count + palette_entry);
    return weight * mat3x4(skin_rows[row], skin_rows[row + 1], skin_rows[row + 2]);
}

void main() {
    const uint instance = list[5 + list[1 + lod] + gl_InstanceIndex];
    const Vertex vertex = vertices[gl_VertexIndex];
    mat3x4 model_from_bind = mat3x4(0);
    for (uint set = 0; set < influence_sets; ++set) {
        const Influences four = influences[first_influences + (gl_VertexIndex - first_vertex) * influence_sets + set];
        for (uint i = 0; i < 4; ++i)
            model_from_bind += weighted_skin_matrix(instance, four.entries[i / 2] >> (i % 2 * 16) & 0xFFFF,
                                                    four.weights[i]);
    }
    const vec3 model = vec4(vertex.position[0], vertex.position[1], vertex.position[2], 1) * model_from_bind;
    const uint row = 3 * instance;
    out_world = vec4(model, 1) * mat3x4(placement_rows[row], placement_rows[row + 1], placement_rows[row + 2]);
    out_color = base_color * unpackUnorm4x8(vertex.color);
    gl_Position = vec4(out_world, 1) * clip_from_world;
}
