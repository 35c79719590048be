// Events that a clip passed in an update: step 7 of docs/controller.md. The includer declares `events`, `event_head`
// and `instance`.

// How many times a step passes an event. Positions are phase + 2^32 * loops. Going forwards, a step passes the
// positions in [before, after), going backwards those in [after, before).
uint times_passed(uint phase, PhaseStep phase_step) {
    const int passed_before = phase < phase_step.before ? 1 : 0,
              passed_after = phase < phase_step.after || phase_step.reached_end ? 1 : 0;
    return uint(abs(phase_step.crossed + passed_after - passed_before));
}

// Counts each time that the event is passed, and stores a record of it while there is room.
void emit_event(ControlEvent event, PhaseStep phase_step, uint layer) {
    const uint count = times_passed(event.phase, phase_step);
    if (count == 0) return;
    const bool forwards = phase_step.cycles > 0;
    // Going backwards, an event right at the starting place is a full cycle away
    const uint distance = forwards ? event.phase - phase_step.before : phase_step.before - event.phase - 1;
    const uint first = atomicAdd(event_head.count, count);
    const uint end = min(count, push.event_capacity - min(first, push.event_capacity));
    uint k = 0;
    do {
        if (end == 0) break;
        const float cycles = (float(distance) + (forwards ? 0 : 1)) * (1.0 / 4294967296.0) + float(k);
        const float time_s = clamp(cycles / abs(phase_step.cycles), 0, 1) * abs(push.time_step_s);
        events[first + k] = EventRecord(push.first_instance + instance, event.event, layer, time_s);
    } while (++k < end);
}

void emit_events(uint clip, PhaseStep phase_step, uint layer) {
    const ControlClip from = load_clip(clip);
    uint i = 0;
    do
        if (i < from.event_count) emit_event(load_event(from.first_event + i), phase_step, layer);
    while (++i < from.event_count);
}
