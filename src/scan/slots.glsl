// Where a walk keeps the transforms of parents with a child still to come.
CONSTANT(2, uint, kSlotTransforms, 1);  // slots of the whole workgroup

#ifdef GPU_SOFTWARE
// A software device has no fast shared memory; a register a slot costs it a select each.
Transform slots[kSlotTransforms / gl_WorkGroupSize.x];
Transform load_slot(uint slot, uint invocation, Transform otherwise) {
    for (uint s = 0; s < slots.length(); ++s)
        if (s == slot) otherwise = slots[s];
    return otherwise;
}
void store_slot(uint slot, uint invocation, Transform transform) {
    for (uint s = 0; s < slots.length(); ++s)
        if (s == slot) slots[s] = transform;
}
#else
shared StoredTransform slots[kSlotTransforms];  // [slot][invocation]
Transform load_slot(uint slot, uint invocation, Transform otherwise) {
    if (slot < kSlotTransforms) return unpack(slots[slot * gl_WorkGroupSize.x + invocation]);
    return otherwise;
}
void store_slot(uint slot, uint invocation, Transform transform) {
    if (slot < kSlotTransforms) slots[slot * gl_WorkGroupSize.x + invocation] = pack(transform);
}
#endif
