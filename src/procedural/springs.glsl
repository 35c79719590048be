// Spring chains: docs/procedural.md. Source of bones as springs with colliders: VRM Consortium, VRMC_springBone 1.0.
// Difference from it: the step is the backward Euler of a damped oscillator, which no time step makes unstable, and its
// numbers do not depend on the frame rate.

// A capsule in the world, with the springs' own radius in its own.
struct Capsule {
    vec3 a, along;
    float radius;
};

Capsule load_capsule(uint word, float bone_radius) {
    const ColliderShape shape = COLLIDER_SHAPE_AT(tables, word);
    const Affine m = world_from_joint_of(shape.joint);
    const vec3 a = affine_point(m, vec3(shape.ax, shape.ay, shape.az)),
               b = affine_point(m, vec3(shape.bx, shape.by, shape.bz));
    const mat3 columns = transpose(mat3(m.row0.xyz, m.row1.xyz, m.row2.xyz));
    const float square = max(max(dot(columns[0], columns[0]), dot(columns[1], columns[1])),
                             dot(columns[2], columns[2]));
    return Capsule(a, b - a, shape.radius * sqrt(square) + bone_radius);
}

vec3 pushed_out(vec3 place, Capsule capsule) {
    const float square = dot(capsule.along, capsule.along);
    const float t = square > 0 ? clamp(dot(place - capsule.a, capsule.along) / square, 0, 1) : 0;
    const vec3 nearest = capsule.a + t * capsule.along, way = place - nearest;
    const float distance = sqrt(dot(way, way));
    return distance < capsule.radius && distance > 0 ? nearest + way * (capsule.radius / distance) : place;
}

Capsule capsules[kColliderLimit];

// Where a bone's end is after the step; `rest` is where the pose has it.
vec3 step_spring(inout SpringState spring, SpringSettings settings, vec3 joint, vec3 rest) {
    const float step_s = max(push.time_step_s, 0), size = distance(joint, rest);
    const vec4 origin = vec4(instance_origin(), 1);
    if (spring.origin.w == 0) spring = SpringState(vec4(rest, 0), vec4(0), origin);
    const vec3 before = spring.place.xyz + (spring.origin.xyz - origin.xyz),
               wind = wind_at(rest) * vec3(push.wind_x, push.wind_y, push.wind_z);
    const vec3 force = settings.stiffness * (rest - before) +
                       vec3(settings.gravity_x, settings.gravity_y, settings.gravity_z) + settings.drag * wind;
    const vec3 velocity = (spring.velocity.xyz + step_s * force) /
                          (1 + step_s * (settings.damping + step_s * settings.stiffness));
    vec3 place = before + step_s * velocity;
    for (uint i = 0; i < settings.collider_count; ++i) place = pushed_out(place, capsules[i]);
    const vec3 way = place - joint;
    const float distance_to = sqrt(dot(way, way));
    place = distance_to > 0 ? joint + way * (size / distance_to) : rest;
    if (step_s > 0) spring.velocity.xyz = (place - before) / step_s;
    spring.place.xyz = place;
    spring.origin = origin;
    return place;
}

void swing(ProceduralChain chain) {
    const SpringSettings settings = SPRING_SETTINGS_AT(tables, chain.rule);
    for (uint i = 0; i < settings.collider_count; ++i)
        capsules[i] = load_capsule(settings.first_collider + kColliderShapeWords * i, settings.radius);
    Affine world_from_parent = world_from_parent_of(first_joint_of(chain));
    for (uint k = 0; k < chain.joint_count; ++k) {
        const ProceduralJoint joint = load_joint(chain, k);
        Affine parent_from_joint = load_local(joint.joint);
        const Affine world_from_joint = affine_multiply(world_from_parent, parent_from_joint);
        const vec3 from = origin_of(world_from_joint),
                   rest = affine_point(world_from_joint, vec3(joint.bone_x, joint.bone_y, joint.bone_z));
        const float size = distance(from, rest);
        const uint row = 3 * (instance * push.spring_count + chain.first_spring + k);
        if (size == 0) {
            springs[row + 2] = pack(vec4(0));  // hidden: where it was is forgotten
        } else {
            SpringState spring = SpringState(unpack(springs[row]), unpack(springs[row + 1]), unpack(springs[row + 2]));
            const vec3 place = step_spring(spring, settings, from, rest);
            springs[row] = pack(spring.place);
            springs[row + 1] = pack(spring.velocity);
            springs[row + 2] = pack(spring.origin);
            parent_from_joint = turn_joint(joint.joint, world_from_parent, parent_from_joint,
                                           arc((rest - from) / size, normalize(place - from)));
        }
        world_from_parent = affine_multiply(world_from_parent, parent_from_joint);
    }
}
