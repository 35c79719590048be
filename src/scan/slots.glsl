// The slots where a walk keeps transforms of parents that wait for further children.
CONSTANT(2, uint, kSlotTransforms, 1);  // slots of all invocations of the workgroup

#ifdef GPU_SOFTWARE
// A software device has no fast shared memory. Slots in registers cost it a select per slot and access.
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
