// Wind: docs/procedural.md.

// A periodic wave, period 1, range -1..1, made of parabolas.
Real wave(Real cycles) {
    const Real x = 2 * fract(cycles) - 1;
    return 4 * x * (1 - abs(x));
}

// Speed of the wind at a place.
Real wind_at(vec3 place) {
    const Real along = dot(instance_origin() + place, vec3(push.wind_x, push.wind_y, push.wind_z)) * push.gust_rate;
    return push.wind_speed *
           (1 + push.gust * (0.5 * wave(push.gust_phase0 - along) + 0.3 * wave(push.gust_phase1 - 2.7 * along) +
                             0.2 * wave(push.gust_phase2 - 7.1 * along)));
}

// Multiples of the golden ratio modulo 1, so that no two instances sway in phase.
Real sway_phase() { return Real((push.first_instance + instance) * 2654435769u) * (1.0 / 4294967296.0); }

void bend_in_wind(ProceduralChain chain) {
    if (push.wind_speed == 0) return;
    const WindSettings settings = load_wind(chain.rule);
    const vec3 direction = vec3(push.wind_x, push.wind_y, push.wind_z);
    const Real phase = sway_phase() + settings.sway_hz * push.sway_time_s;
    Affine world_from_parent = world_from_parent_of(load_joint(chain, 0).joint);
    for (uint k = 0; k < chain.joint_count; ++k) {
        const ProceduralJoint joint = load_joint(chain, k);
        Affine parent_from_joint = load_local(joint.joint);
        const Affine world_from_joint = affine_multiply(world_from_parent, parent_from_joint);
        const vec3 bone = affine_vector(world_from_joint, vec3(joint.bone_x, joint.bone_y, joint.bone_z));
        const Real size = sqrt(dot(bone, bone));
        const vec3 across = cross(bone, direction) / max(size, 1e-30);
        const Real sine = sqrt(dot(across, across));
        if (sine > kParallel) {
            const Real angle_rad = angle_of(sine, dot(bone, direction) / size);
            const Real sway = push.wind_speed * settings.sway_rad *
                              wave(phase - 0.07 * Real(chain.first_generation + k));
            const Real bend_rad = clamp((wind_at(origin_of(world_from_joint)) * settings.bend_rad + sway) * sine,
                                        angle_rad - kPi, angle_rad);
            parent_from_joint = turn_joint(joint.joint, world_from_parent, parent_from_joint,
                                           turn_about(across / sine, bend_rad));
        }
        world_from_parent = affine_multiply(world_from_parent, parent_from_joint);
    }
}
