// How far a clip moves its character: step 8 of docs/controller.md.
// The includer declares the table `root_rows`.
#include "gpu/ground.glsl"

// The place of the root at a phase, relative to the beginning of the clip.
vec4 place_at(ControlClip clip, uint phase) {
    uint row, fraction;
    umulExtended(phase, clip.root_count - 1, row, fraction);
    const uint at = clip.first_root + row;
    const vec4 a = uintBitsToFloat(ROW_AT(root_rows, at)),
               b = uintBitsToFloat(ROW_AT(root_rows, min(at + 1, clip.first_root + clip.root_count - 1)));
    return turned_to_length_one(mix(a, b, float(fraction) * (1.0 / 4294967296.0)));
}

vec4 cycles_of(ControlClip clip, int count) {
    vec4 cycle = uintBitsToFloat(ROW_AT(root_rows, clip.first_root + clip.root_count - 1));
    if (count < 0) cycle = inverse_place(cycle);
    vec4 all = vec4(0, 0, 1, 0);
    for (uint rest = uint(abs(count)); rest > 0; rest >>= 1) {
        if ((rest & 1) != 0) all = compose_places(all, cycle);
        cycle = compose_places(cycle, cycle);
    }
    return all;
}

// The move from one phase to the other, with the whole cycles between them.
vec4 move_of(ControlClip clip, PhaseStep phase_step) {
    vec4 move = vec4(0, 0, 1, 0);
    if (clip.root_count > 0) {
        move = cycles_of(clip, phase_step.crossed);
        move = compose_places(move, place_at(clip, phase_step.after));
        move = compose_places(inverse_place(place_at(clip, phase_step.before)), move);
    }
    return move;
}

vec4 move_sum = vec4(0);  // of this update, by weight

void add_move(uint clip, PhaseStep phase_step, float weight) {
    if ((push.flags & kPushHasRootMotion) != 0) move_sum += weight * move_of(load_clip(clip), phase_step);
}

// Scales the move of a layer of which only the part `shown` (0..1) is shown. The rest counts as standing still.
void scale_move(float shown) { move_sum = shown * move_sum + vec4(0, 0, 1 - shown, 0); }

// Reports the move and, if root motion is applied, places the instance at base * place. What rounding drops from x and
// z is added to the next move (Kahan, 1965). Otherwise the error of many short steps would add up.
void end_move() {
    if ((push.flags & kPushHasRootMotion) == 0) return;
    const vec4 move = move_sum == vec4(0) ? vec4(0, 0, 1, 0) : turned_to_length_one(move_sum);
    roots[instance].move = move;
    if ((push.flags & kPushMovesPlacements) == 0) return;
    const vec4 before = roots[instance].place;
    const vec2 remainder = root_remainders[instance], step = compose_places(vec4(remainder, before.zw), move).xy,
               reached = vec2(sum(before.x, step.x), sum(before.y, step.y));
    root_remainders[instance] = vec2(difference(step.x, difference(reached.x, before.x)),
                                     difference(step.y, difference(reached.y, before.y)));
    const vec4 place = vec4(reached, turned_to_length_one(compose_places(before, move)).zw);
    roots[instance].place = place;
    for (uint row = 0; row < 3; ++row) placements[3 * instance + row] = placed_row(roots[instance].base[row], place);
}
