// What a view sees, and in how much detail; defined by cull_reference.h.
#include "gpu/buffers_io.h"
#include "cull/cull_io.h"
#include "gpu/affine.glsl"
#include "gpu/table.glsl"

TABLE_OF_ROWS(kViewBuffer, view_rows);             // CullView
TABLE_OF_ROWS(kPlacementsBuffer, placement_rows);  // world_from_model

vec4 view_row(uint index) { return uintBitsToFloat(ROW_AT(view_rows, index)); }

CullView load_view() {
    CullView view;
    for (uint i = 0; i < 6; ++i) view.planes[i] = view_row(i);
    for (uint i = 0; i < 4; ++i) view.clip_from_world[i] = view_row(6 + i);
    view.eye = view_row(10);
    view.shadow = view_row(11);
    const uvec4 last = ROW_AT(view_rows, 12);
    view.update_number = last.x;
    view.occlusion = last.y;
    view.ground = uintBitsToFloat(last.z);
    view.shared_pixels = uintBitsToFloat(last.w);
    return view;
}

// An upper bound of how much m scales a length: the root of the largest row sum of the products of m's columns. If the
// columns are at right angles it is the length of the longest one.
float largest_scale(Affine m) {
    const vec3 x = affine_column(m, 0), y = affine_column(m, 1), z = affine_column(m, 2);
    const float xy = abs(dot(x, y)), xz = abs(dot(x, z)), yz = abs(dot(y, z));
    return sqrt(max(max(dot(x, x) + xy + xz, dot(y, y) + xy + yz), dot(z, z) + xz + yz));
}

// The path of a box's shadow: from its highest point down to the ground.
vec3 shadow_of(CullView view, Affine world_from_model, vec3 centre, vec3 half_extent) {
    const float top = dot(world_from_model.row1, vec4(centre, 1)) + dot(abs(world_from_model.row1.xyz), half_extent);
    return view.shadow.xyz * clamp((top - view.ground) / max(-view.shadow.y, 1e-30), 0, 1);
}

// The box and its shadow's path are outside if they lie behind one of the planes.
bool is_seen(CullView view, Affine world_from_model, vec3 centre, vec3 half_extent) {
    const vec3 middle = affine_point(world_from_model, centre),
               shadow = shadow_of(view, world_from_model, centre, half_extent), x = affine_column(world_from_model, 0),
               y = affine_column(world_from_model, 1), z = affine_column(world_from_model, 2);
    bool seen = true;
    for (uint i = 0; i < 6; ++i) {
        const vec3 normal = view.planes[i].xyz;
        const vec3 along = vec3(dot(normal, x), dot(normal, y), dot(normal, z));
        const float reach = dot(abs(along), half_extent) + max(dot(normal, shadow), 0);
        seen = seen && dot(normal, middle) + view.planes[i].w + reach >= 0;
    }
    return seen;
}

// Distance of the eye from the box's bounding sphere, in world space; not positive inside it.
float distance_to_box(CullView view, Affine world_from_model, vec3 centre, vec3 half_extent) {
    return distance(affine_point(world_from_model, centre), view.eye.xyz) -
           largest_scale(world_from_model) * length(half_extent);
}

// The coarsest level whose error the view does not see. Errors never decrease from one level to the next.
uint lod_of(CullView view, float distance_to_it, float scale, vec4 lod_errors, uint lod_count) {
    uint lod = 0;
    for (uint k = 1; k < kLodCount; ++k)
        if (k < lod_count && lod_errors[k] * scale * view.eye.w <= distance_to_it) lod = k;
    return lod;
}

// An instance is animated in one of every 1, 2, 4 or 8 updates, so that it moves by about the same number of pixels
// between two of them.
uint period_of(CullView view, float distance_to_it, float scale, vec3 half_extent) {
    const float size = 2 * scale * length(half_extent) * view.shadow.w;
    uint period_log2 = 0;
    for (uint k = 1; k <= kMaxPeriodLog2; ++k)
        if (size * float(1u << (k - 1)) < distance_to_it) period_log2 = k;
    return view.shadow.w == 0 ? 1 : 1u << period_log2;
}

// The verdict on an instance that is drawn. `state` is its state after the last update; it is replaced by the one after
// this update.
uint verdict_of(CullView view, CullPush push, Affine world_from_model, uint instance, INOUT(uint) state) {
    const float distance_to_it = distance_to_box(view, world_from_model, push.centre.xyz, push.half_extent.xyz),
                scale = largest_scale(world_from_model);
    const uint lod = lod_of(view, distance_to_it, scale, push.lod_errors, push.lod_count);
    const uint period = push.may_skip != 0 ? period_of(view, distance_to_it, scale, push.half_extent.xyz) : 1;
    const bool was_drawn = (state & kStateDrawn) != 0;
    const uint joint_set = min(lod, push.joint_set_count - 1), last_set = state >> kStateSetShift;
    const bool has_joints = was_drawn && joint_set >= last_set;  // coarser sets are parts of finer ones
    const bool is_due = !has_joints || ((view.update_number + instance) & (period - 1)) == 0;  // staggered
    const bool is_at_once = is_due && (!has_joints || period == 1);
    uint left = was_drawn ? state >> kStateLeftShift & kStateLeftMask : 0;
    if (is_due) left = is_at_once ? 0 : period;
    uint verdict = kVerdictInView | kVerdictDrawn | lod;
    if (is_due)
        verdict |= kVerdictAnimated | (joint_set + (is_at_once ? kAnimated : kAnimatedAhead)) << kVerdictSectionShift;
    if (!is_at_once && (left > 0 || push.keeps_previous != 0)) verdict |= kVerdictInterpolated;
    if (!has_joints && push.keeps_previous != 0) verdict |= kVerdictAppears;
    state = kStateDrawn | kStateVisible | (left > 0 ? left - 1 : 0) << kStateLeftShift | left << kStateStepShift |
            (is_due ? joint_set : last_set) << kStateSetShift;
    return verdict;
}
