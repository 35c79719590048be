// The voices of an instance, written as they come: step 9 of docs/controller.md. The includer declares `voices`, `voice_times`, `instance` and find_rows().

// One voice waits until it is known what follows it.
Voice waiting;
float waiting_time_s, voice_time_s;  // its clip's time, and that of the last voice_of()
uint voice_count;  // the waiting one included
uint layer_flags;
float voices_layer_weight;
bool layer_begins, layer_is_lowest, layer_covers;

void begin_voices() {
    voice_count = 0;
    layer_is_lowest = true;
}

void store_waiting() {
    const uint index = instance * push.voice_limit + voice_count - 1;
    voices[index] = waiting;
    if ((push.flags & kPushTellsTimes) != 0) voice_times[index] = waiting_time_s;
}

void append_voice(Voice voice) {
    if (voice_count > 0) store_waiting();
    waiting = voice;
    waiting_time_s = voice_time_s;
    ++voice_count;
}

Voice voice_of(uint clip, uint phase, float weight) {
    const ClipAxis axis = load_axis(clip);
    voice_time_s = float(phase) * (1.0 / 4294967296.0) * axis.duration_s;
    const SlotCursor cursor = find_rows(axis, voice_time_s);
    return Voice(clip * push.joint_count, cursor.earlier, cursor.later, cursor.fraction, weight, 1, axis.first_row, kVoiceBeginsLayer | kVoiceEndsLayer);
}

void append_rest_pose() {
    append_voice(voice_of(layout_of_group.clip_count, 0, 1));
}

void begin_layer(LayerState state, float weight) {
    layer_flags = (state.mode == kModeAdditive ? kVoiceAdditive : 0) | (state.mask == kAbsent ? 0 : kVoiceMasked | state.mask << kVoiceMaskShift);
    layer_covers = layer_flags == 0 && weight >= 1;
    voices_layer_weight = weight;
    layer_begins = true;
}

void add_voice(uint clip, uint phase, float weight) {
    if (layer_is_lowest && !layer_covers) append_rest_pose();
    Voice voice = voice_of(clip, phase, weight);
    voice.layer_weight = voices_layer_weight;
    voice.flags = layer_flags | kVoiceEndsLayer | (layer_begins ? kVoiceBeginsLayer : 0);
    if (!layer_begins) waiting.flags &= ~kVoiceEndsLayer;
    append_voice(voice);
    layer_begins = false;
    layer_is_lowest = false;
}

void end_voices() {
    if (voice_count == 0) append_rest_pose();
    waiting.flags |= kVoiceEnds;
    store_waiting();
}
