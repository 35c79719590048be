// The active clips of an instance -> the pose of one joint. Included by the staged kernel and by the fused one; defined
// by active_clips_reference.h. The includer declares what sample/clip_pose.glsl needs (or defines the two functions of
// that file itself), `push`, the constant kPacked, and two tables: `active_clips` (TABLE_OF_ROWS, two rows an
// ActiveClip: [instance][push.active_clip_limit]) and `masks` (TABLE_OF_WORDS, floats: [mask][rig_joint_count()]).
//
// Layers are applied from the lowest up. A layer's pose is the weighted sum of its active clips. Each rotation is first
// negated if it is not in the hemisphere of the sum so far, and the sum is normalised at the end. Source of the sum and
// its limits: Gramkow, On Averaging Rotations, IJCV 42, 2001. An additive layer sums the differences from its clips'
// first rows. Both kinds of layer share one path, since a pose equals its difference from the identity.
//
// If ACTIVE_CLIPS_IN_ORDER is defined, the includer includes blend/model_rotations.glsl, and layers can blend their
// rotations in model space. Otherwise no layer does.
//
// The loop samples once per iteration, to keep code and register count small: an additive active clip takes two
// iterations, its reference first. The only exit is at the end of the body, since a software device would run the code
// behind a `break` once more.
#include "blend/blend.glsl"
#include "control/controller_io.h"
#ifndef FUSED_ROWS
#include "sample/clip_pose.glsl"
#endif

const JointPose kIdentityPose = JointPose(vec4(0, 0, 0, 1), vec4(0), vec4(1));
const JointPose kEmptySum = JointPose(vec4(0), vec4(0), vec4(0));
// Below this squared length the direction of a sum of rotations is only rounding error
const float kCancelled = 1e-12;
const float kNoScale = 1e-8;  // scales below this have no ratio

ActiveClip active_clip_at(uint index) {
    const uvec4 a = ROW_AT(active_clips, 2 * index), b = ROW_AT(active_clips, 2 * index + 1);
    return ActiveClip(a.x, a.y, a.z, uintBitsToFloat(a.w), uintBitsToFloat(b.x), uintBitsToFloat(b.y), b.z, b.w);
}

// Weight of the active clip's layer at this joint.
float layer_weight(ActiveClip active_clip, uint joint) {
    const bool is_masked = (active_clip.flags & kActiveClipMasked) != 0;
    const float mask = uintBitsToFloat(
        WORD_AT(masks, is_masked ? (active_clip.flags >> kActiveClipMaskShift) * rig_joint_count() + joint : 0));
    return is_masked ? active_clip.layer_weight * mask : active_clip.layer_weight;
}

// With `only_rotation`, translation is 0 and scale is 1.
JointPose sample_active_clip(ActiveClip active_clip, uint joint, bool at_reference, bool only_rotation) {
    const ClipCursor cursor = ClipCursor(
        active_clip.first_track, at_reference ? active_clip.reference_row : active_clip.earlier,
        at_reference ? active_clip.reference_row : active_clip.later, at_reference ? 0 : active_clip.fraction);
    if (only_rotation) return JointPose(clip_rotation(cursor, joint), kIdentityPose.translation, kIdentityPose.scale);
    return clip_pose(cursor, joint);
}

// The difference that takes `from` to `to`, in the parent's space: a rotation, a translation and a ratio of scales.
JointPose pose_difference(JointPose to, JointPose from) {
    const bvec4 has_no_ratio = lessThan(abs(from.scale), vec4(kNoScale));
    return JointPose(quaternion_multiply(to.rotation, vec4(-from.rotation.xyz, from.rotation.w)),
                     to.translation - from.translation,
                     mix(to.scale / mix(from.scale, vec4(1), has_no_ratio), vec4(1), has_no_ratio));
}

// Additive differences always take the shorter rotation, so that their sum does not depend on the order.
JointPose add_active_clip(JointPose sum, JointPose part, float weight, bool is_additive) {
    const vec4 side = is_additive ? kIdentityPose.rotation : sum.rotation;
    return JointPose(sum.rotation + part.rotation * (dot(part.rotation, side) < 0 ? -weight : weight),
                     sum.translation + part.translation * weight, sum.scale + part.scale * weight);
}

// `layer` on `below`, 0 < weight <= 1; an override of weight 1 yields the layer bit for bit.
JointPose apply_layer(JointPose layer, JointPose below, float weight, bool is_additive) {
    JointPose base = below;
    if (is_additive) base = kIdentityPose;
    JointPose part = layer;
    if (weight < 1) part = blend_joint(layer, base, weight);
    if (!is_additive) return part;
    return JointPose(quaternion_multiply(part.rotation, below.rotation), below.translation + part.translation,
                     below.scale * part.scale);
}

JointPose mix_active_clips(uint instance, uint joint, bool only_rotation) {
    uint index = instance * push.active_clip_limit;
    const uint end = index + push.active_clip_limit;  // kActiveClipEnds comes earlier, except before control first ran
    JointPose result = kIdentityPose, sum = kEmptySum, from = kIdentityPose;
    bool is_lowest = true, is_reference = false;
#ifdef ACTIVE_CLIPS_IN_ORDER
    uint model_layer = 0;
#endif
    for (;;) {
        const ActiveClip active_clip = active_clip_at(index);
        const bool is_additive = (active_clip.flags & kActiveClipAdditive) != 0,
                   ends_layer = (active_clip.flags & kActiveClipEndsLayer) != 0;
        const float weight = is_lowest ? 1 : layer_weight(active_clip, joint);  // the lowest layer has full weight
        is_reference = is_additive && !is_reference;
#ifdef ACTIVE_CLIPS_IN_ORDER
        // For the lowest layer, blending in either space gives the same rotations
        const bool in_model_space = !is_lowest && (active_clip.flags & kActiveClipModelRotations) != 0;
#else
        const bool in_model_space = false;
#endif
        if (weight > 0 || in_model_space) {
            const JointPose pose = sample_active_clip(active_clip, joint, is_reference, only_rotation);
            if (is_reference) {
                from = pose;
            } else {
                const JointPose part = pose_difference(pose, from);
                sum = add_active_clip(sum, part, active_clip.weight, is_additive);
                from = kIdentityPose;
                if (ends_layer) {
                    const float square = dot(sum.rotation, sum.rotation);
                    sum.rotation = square < kCancelled ? part.rotation : sum.rotation * inversesqrt(square);
#ifdef ACTIVE_CLIPS_IN_ORDER
                    if (in_model_space)
                        result = apply_in_model_space(instance, joint, model_layer++, sum, result, weight);
                    else
#endif
                        result = apply_layer(sum, result, weight, is_additive);
                    sum = kEmptySum;
                }
            }
        }
        if (!is_reference) {
            is_lowest = is_lowest && !ends_layer;
            ++index;
        }
        if (!is_reference && (index == end || (active_clip.flags & kActiveClipEnds) != 0)) break;
    }
    return result;
}

JointPose active_clips_pose(uint instance, uint joint) { return mix_active_clips(instance, joint, false); }

// The rotation of a joint whose translation and scale are the same in all clips.
vec4 active_clips_rotation(uint instance, uint joint) { return mix_active_clips(instance, joint, true).rotation; }
