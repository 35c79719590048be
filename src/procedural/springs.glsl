// Spring chains: docs/procedural.md. Source of bones as springs with colliders: VRM Consortium, VRMC_springBone 1.0.
// Difference from it: integrates a damped oscillator by backward Euler, which is stable for any time step, and whose
// parameters do not depend on the frame rate.

// A capsule in the world; its radius includes the springs' own.
struct Capsule {
    vec3 a, along;
    Real radius;
};

Capsule load_capsule(uint first, uint index, Real bone_radius) {
    const ColliderShape shape = load_collider(first, index);
    const Affine m = world_from_joint_of(shape.joint);
    const vec3 a = affine_point(m, vec3(shape.ax, shape.ay, shape.az)),
               b = affine_point(m, vec3(shape.bx, shape.by, shape.bz)), x = affine_column(m, 0),
               y = affine_column(m, 1), z = affine_column(m, 2);
    const Real scale = sqrt(max(max(dot(x, x), dot(y, y)), dot(z, z)));
    const Capsule capsule = {a, b - a, shape.radius * scale + bone_radius};
    return capsule;
}

vec3 pushed_out(vec3 place, Capsule capsule) {
    const Real square = dot(capsule.along, capsule.along);
    const Real t = square > 0 ? clamp(dot(place - capsule.a, capsule.along) / square, 0, 1) : 0;
    const vec3 nearest = capsule.a + t * capsule.along, way = place - nearest;
    const Real distance = sqrt(dot(way, way));
    return distance < capsule.radius && distance > 0 ? nearest + way * (capsule.radius / distance) : place;
}

Capsule capsules[kColliderLimit];

// Advances the spring and returns the bone's new direction. `rest`: where the bone ends in the pose.
vec3 step_spring(INOUT(SpringState) spring, SpringSettings settings, vec3 joint, vec3 rest) {
    const Real step_s = max(push.time_step_s, 0), size = distance(joint, rest);
    const vec4 origin = vec4(instance_origin(), 1);
    const SpringState at_rest = {vec4(rest, 0), vec4(0), origin};
    if (spring.origin.w == 0) spring = at_rest;
    const vec3 before = spring.place.xyz + (spring.origin.xyz - origin.xyz),
               wind = wind_at(rest) * vec3(push.wind_x, push.wind_y, push.wind_z);
    const vec3 force = settings.stiffness * (rest - before) +
                       vec3(settings.gravity_x, settings.gravity_y, settings.gravity_z) + settings.drag * wind;
    const vec3 velocity = (spring.velocity.xyz + step_s * force) /
                          (1 + step_s * (settings.damping + step_s * settings.stiffness));
    vec3 place = before + step_s * velocity;
    for (uint i = 0; i < settings.collider_count; ++i) place = pushed_out(place, capsules[i]);
    const vec3 way = place - joint;
    const Real distance_to = sqrt(dot(way, way));
    const vec3 towards = distance_to > 0 ? way / distance_to : (rest - joint) / size;
    place = joint + towards * size;
    if (step_s > 0) spring.velocity.xyz = (place - before) / step_s;
    spring.place.xyz = place;
    spring.origin = origin;
    return towards;
}

void swing(ProceduralChain chain) {
    const SpringSettings settings = load_spring(chain.rule);
    for (uint i = 0; i < settings.collider_count; ++i)
        capsules[i] = load_capsule(settings.first_collider, i, settings.radius);
    Affine world_from_parent = world_from_parent_of(load_joint(chain, 0).joint);
    for (uint k = 0; k < chain.joint_count; ++k) {
        const ProceduralJoint joint = load_joint(chain, k);
        Affine parent_from_joint = load_local(joint.joint);
        const Affine world_from_joint = affine_multiply(world_from_parent, parent_from_joint);
        const vec3 from = origin_of(world_from_joint),
                   rest = affine_point(world_from_joint, vec3(joint.bone_x, joint.bone_y, joint.bone_z));
        const Real size = distance(from, rest);
        if (size == 0) {
            forget_spring(chain.first_spring + k);  // the joint has no bone, or is scaled to zero
        } else {
            SpringState spring = load_spring_state(chain.first_spring + k);
            const vec3 towards = step_spring(spring, settings, from, rest);
            store_spring_state(chain.first_spring + k, spring);
            parent_from_joint = turn_joint(joint.joint, world_from_parent, parent_from_joint,
                                           arc((rest - from) / size, towards));
        }
        world_from_parent = affine_multiply(world_from_parent, parent_from_joint);
    }
}
