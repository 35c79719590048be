// Transforms of joints in the world, and turns of joints there. "World" here has the world's axes, but the instance's
// origin, so that floats keep their precision far from the world's origin, where springs would otherwise jitter. Also
// compiled as C++ (gpu/glsl.h). The includer declares what gpu/angles.glsl does, parent_of(joint), load_local(joint),
// placement() of the instance, and store_turned(joint, turn, turned).
#include "gpu/affine.glsl"
#include "gpu/quaternion.glsl"

const Real kParallel = 1e-6;  // if the sine of the angle between two directions is smaller, they span no plane

vec3 origin_of(Affine m) { return vec3(m.row0.w, m.row1.w, m.row2.w); }

// The instance's origin, in the true world.
vec3 instance_origin() { return origin_of(placement()); }

// The transform of a joint's parent: the placement times all joints above.
Affine world_from_parent_of(uint joint) {
    Affine model_from_parent = kIdentity;
    for (uint above = parent_of(joint); above != kNone; above = parent_of(above))
        model_from_parent = affine_multiply(load_local(above), model_from_parent);
    Affine from_model = placement();
    from_model.row0.w = from_model.row1.w = from_model.row2.w = 0;
    return affine_multiply(from_model, model_from_parent);
}

Affine world_from_joint_of(uint joint) { return affine_multiply(world_from_parent_of(joint), load_local(joint)); }

// Converts a turn from world space to another space, whose axes rotate the turn's axis. Skewed axes are orthogonalized,
// x first. A space without volume has no turns.
vec4 turn_within(Affine world_from_space, vec4 turn) {
    const vec3 a = affine_column(world_from_space, 0), b = affine_column(world_from_space, 1),
               c = affine_column(world_from_space, 2);
    const vec3 x = a * inversesqrt(max(dot(a, a), 1e-30)), across = b - x * dot(x, b);
    const vec3 y = across * inversesqrt(max(dot(across, across), 1e-30)), z = cross(x, y);
    if (dot(z, z) < 0.5 || abs(dot(z, c)) <= kParallel * length(c)) return vec4(0, 0, 0, 1);
    const Real side = dot(z, c) < 0 ? -1 : 1;
    return vec4(dot(x, turn.xyz) * side, dot(y, turn.xyz) * side, dot(z, turn.xyz), turn.w);
}

// Turns a joint about its origin by a world-space turn; stores and returns its new parent_from_joint.
Affine turn_joint(uint joint, Affine world_from_parent, Affine parent_from_joint, vec4 turn) {
    const vec4 q = turn_within(world_from_parent, turn);
    const Affine rotation = affine_from_trs(q, vec3(0), vec3(1)), m = parent_from_joint;
    const vec3 r0 = rotation.row0.xyz, r1 = rotation.row1.xyz, r2 = rotation.row2.xyz;
    const Affine turned = {vec4(r0.x * m.row0.xyz + r0.y * m.row1.xyz + r0.z * m.row2.xyz, m.row0.w),
                           vec4(r1.x * m.row0.xyz + r1.y * m.row1.xyz + r1.z * m.row2.xyz, m.row1.w),
                           vec4(r2.x * m.row0.xyz + r2.y * m.row1.xyz + r2.z * m.row2.xyz, m.row2.w)};
    store_turned(joint, q, turned);
    return turned;
}

// The shortest turn from one direction to another, both of length 1.
vec4 arc(vec3 from, vec3 to) {
    const vec4 q = vec4(cross(from, to), 1 + dot(from, to));
    const vec3 across = cross(from, abs(from.x) < 0.7 ? vec3(1, 0, 0) : vec3(0, 1, 0));
    return q.w < kParallel ? vec4(normalize(across), 0) : q * inversesqrt(dot(q, q));
}

// The angle, 0..pi, from its sine (not negative) and cosine.
Real angle_of(Real sine, Real cosine) {
    const Real across = atan_unit(min(sine, abs(cosine)) / max(max(sine, abs(cosine)), 1e-30));
    const Real acute = abs(cosine) < sine ? kHalfPi - across : across;
    return cosine < 0 ? kPi - acute : acute;
}

// A turn about an axis of length 1, by -pi..pi.
vec4 turn_about(vec3 axis, Real angle_rad) {
    const Real half_rad = min(0.5 * abs(angle_rad), kHalfPi);
    return vec4(axis * (angle_rad < 0 ? -sin_quarter(half_rad) : sin_quarter(half_rad)),
                sin_quarter(kHalfPi - half_rad));
}
