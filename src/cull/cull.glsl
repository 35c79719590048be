// What a view sees, and in how much detail; defined by cull_reference.h.
#include "cull/cull_io.h"
#include "gpu/affine.glsl"

float largest_scale(Affine m) {
    const vec3 x = vec3(m.row0.x, m.row1.x, m.row2.x), y = vec3(m.row0.y, m.row1.y, m.row2.y), z = vec3(m.row0.z, m.row1.z, m.row2.z);
    return sqrt(max(max(dot(x, x), dot(y, y)), dot(z, z)));
}

// The box, and the way that its shadow takes, are outside where they lie behind one plane.
bool is_seen(CullView view, Affine world_from_model, vec3 centre, vec3 half_extent) {
    const vec3 middle = affine_point(world_from_model, centre);
    bool seen = true;
    for (uint i = 0; i < 6; ++i) {
        const vec3 normal = view.planes[i].xyz;
        const vec3 along = vec3(dot(normal, vec3(world_from_model.row0.x, world_from_model.row1.x, world_from_model.row2.x)),
                                dot(normal, vec3(world_from_model.row0.y, world_from_model.row1.y, world_from_model.row2.y)),
                                dot(normal, vec3(world_from_model.row0.z, world_from_model.row1.z, world_from_model.row2.z)));
        const float reach = dot(abs(along), half_extent) + max(dot(normal, view.shadow.xyz), 0);
        seen = seen && dot(normal, middle) + view.planes[i].w + reach >= 0;
    }
    return seen;
}

// The coarsest level whose error the view does not see; errors do not fall from level to level.
uint detail_of(CullView view, Affine world_from_model, vec3 centre, vec3 half_extent, vec4 detail_errors, uint detail_count) {
    const float scale = largest_scale(world_from_model);
    const float distance_to_it = distance(affine_point(world_from_model, centre), view.eye.xyz) - scale * length(half_extent);
    uint detail = 0;
    for (uint k = 1; k < kDetailLevels; ++k)
        if (k < detail_count && detail_errors[k] * scale * view.eye.w <= distance_to_it) detail = k;
    return detail;
}
