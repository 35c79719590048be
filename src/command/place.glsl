// Sets an instance's placement from a command. The includer declares the buffers `placements`, `roots` and
// `root_remainders`, and `push`.

void place(InstanceCommand command) {
    const Affine world_from_model = Affine(uintBitsToFloat(command.data[0]), uintBitsToFloat(command.data[1]),
                                           uintBitsToFloat(command.data[2]));
    placements[command.instance] = world_from_model;
    if ((push.flags & kHasRoots) == 0) return;
    const vec4 here = vec4(0, 0, 1, 0);
    roots[command.instance].move = here;
    roots[command.instance].place = here;
    if ((push.flags & kMovesPlacements) != 0) root_remainders[command.instance] = vec2(0);
    roots[command.instance].base[0] = world_from_model.row0;
    roots[command.instance].base[1] = world_from_model.row1;
    roots[command.instance].base[2] = world_from_model.row2;
}
