// Look-at and two-bone inverse kinematics: docs/procedural.md.

// The weight with which a rule follows a target; 0 if the target's place is invalid, since shaders may write anything.
Real weight_of(vec4 target, Real weight) {
    const bool is_place = abs(target.x) <= kFarthest && abs(target.y) <= kFarthest && abs(target.z) <= kFarthest;
    return is_place && target.w > 0 ? weight * min(target.w, 1) : 0;
}

void look_at(ProceduralChain chain) {
    const LookAtSettings settings = load_look_at(chain.rule);
    const vec4 target = load_target(settings.target);
    const Real weight = weight_of(target, settings.weight);
    if (weight <= 0) return;
    const uint joint = load_joint(chain, 0).joint;
    const Affine world_from_parent = world_from_parent_of(joint), parent_from_joint = load_local(joint);
    const Affine world_from_joint = affine_multiply(world_from_parent, parent_from_joint);
    const vec3 forward = affine_vector(world_from_joint,
                                       vec3(settings.forward_x, settings.forward_y, settings.forward_z)),
               way = target.xyz - instance_origin() - origin_of(world_from_joint);
    const Real size = sqrt(dot(forward, forward) * dot(way, way));
    const vec3 across = cross(forward, way) / max(size, 1e-30);
    const Real sine = sqrt(dot(across, across));
    if (sine <= kParallel) return;
    const Real angle_rad = min(angle_of(sine, dot(forward, way) / size), settings.limit_rad);
    turn_joint(joint, world_from_parent, parent_from_joint, turn_about(across / sine, angle_rad * weight));
}

void reach(ProceduralChain chain) {
    const ReachSettings settings = load_reach(chain.rule);
    const vec4 target = load_target(settings.target);
    const Real weight = weight_of(target, settings.weight);
    if (weight <= 0) return;
    const uint upper = load_joint(chain, 0).joint, middle = load_joint(chain, 1).joint,
               end = load_joint(chain, 2).joint;
    const Affine world_from_parent = world_from_parent_of(upper), parent_from_upper = load_local(upper),
                 upper_from_middle = load_local(middle);
    const Affine world_from_upper = affine_multiply(world_from_parent, parent_from_upper),
                 world_from_middle = affine_multiply(world_from_upper, upper_from_middle);
    const vec3 a = origin_of(world_from_upper), b = origin_of(world_from_middle),
               c = affine_point(world_from_middle, origin_of(load_local(end)));
    const vec3 goal = mix(c, target.xyz - instance_origin(), weight);
    const Real upper_size = distance(a, b), lower_size = distance(b, c), straight = distance(a, c);
    const Real far = upper_size + lower_size, near = abs(upper_size - lower_size), wanted = distance(a, goal);
    if (min(min(upper_size, lower_size), min(wanted, straight)) <= kParallel * far) return;
    const vec3 to_goal = (goal - a) / wanted;
    const Real reached = clamp(wanted, near, far);
    const vec4 swing = arc((c - a) / straight, to_goal);

    // Heron's formula, which gives an exactly straight limb if it is stretched. The middle joint lies `along` in the
    // direction of the goal and `aside` perpendicular to it, on the same side as in the pose.
    const vec3 upper_bone = quaternion_rotate(swing, b - a),
               pole = affine_vector(world_from_parent, vec3(settings.pole_x, settings.pole_y, settings.pole_z));
    vec3 side = upper_bone - to_goal * dot(upper_bone, to_goal);
    if (dot(side, side) < 1e-6 * upper_size * upper_size) side = pole - to_goal * dot(pole, to_goal);
    if (dot(side, side) == 0) return;
    const Real along = (upper_size * upper_size + reached * reached - lower_size * lower_size) / (2 * reached),
               aside = sqrt(max((far - reached) * (far + reached) * (reached - near) * (reached + near), 0)) /
                       (2 * reached);
    const vec3 wanted_bone = to_goal * along + normalize(side) * aside;
    const vec4 upper_turn = quaternion_multiply(arc(upper_bone / upper_size, wanted_bone / upper_size), swing);
    const Affine turned_upper = turn_joint(upper, world_from_parent, parent_from_upper, upper_turn);
    const Affine world_from_turned = affine_multiply(world_from_parent, turned_upper),
                 world_from_lower = affine_multiply(world_from_turned, upper_from_middle);
    const vec3 lower_bone = affine_vector(world_from_lower, origin_of(load_local(end)));
    turn_joint(middle, world_from_turned, upper_from_middle,
               arc(normalize(lower_bone), normalize(to_goal * reached - wanted_bone)));
}

void move_chain(uint kind, ProceduralChain chain) {
    if (kind == kChainWind)
        bend_in_wind(chain);
    else if (kind == kChainSpring)
        swing(chain);
    else if (kind == kChainLookAt)
        look_at(chain);
    else
        reach(chain);
}
