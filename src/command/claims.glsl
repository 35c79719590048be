// Selects the commands that are carried out. The includer declares the buffers `commands`, with their head, and
// `claims`, and `push`.

uint command_count() { return min(head.count, push.capacity); }

uint claims_of_instance() {
    return kFirstOtherClaim + ((push.flags & kHasController) != 0 ? 2 * push.layer_count + push.parameter_count : 1);
}

uint claim_of(InstanceCommand command) {
    uint claim = kClaimPopulation;
    if (command.kind == kPlace) claim = kClaimPlacement;
    if (command.kind == kSetLook) claim = kClaimLook;
    if (command.kind == kPlayback) claim = kFirstOtherClaim;
    if (command.kind == kPlay) claim = kFirstOtherClaim + command.target;
    if (command.kind == kBlendLayer) claim = kFirstOtherClaim + push.layer_count + command.target;
    if (command.kind == kSetParameter) claim = kFirstOtherClaim + 2 * push.layer_count + command.target;
    return command.instance * claims_of_instance() + claim;
}

// Whether the i-th command holds the claim and is to be carried out; if so, frees the claim for the next update.
bool takes_claim(uint i, InstanceCommand command) {
    return atomicCompSwap(claims[claim_of(command)], i + 1, 0) == i + 1;
}
