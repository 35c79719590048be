// The voices of an instance, written as they come: step 9 of docs/controller.md. The includer declares `voices`,
// `voice_times`, `instance` and find_rows().

uint voice_count;    // the rest pose included
bool has_rest_pose;  // below the others
Voice newest;
float voice_time_s;  // of the clip of the last voice_of()
uint layer_flags;
float voices_layer_weight;

void begin_voices() {
    voice_count = 0;
    has_rest_pose = false;
}

Voice voice_of(uint clip, uint phase, float weight) {
    const ClipAxis axis = load_axis(clip);
    voice_time_s = float(phase) * (1.0 / 4294967296.0) * axis.duration_s;
    const SlotCursor cursor = find_rows(axis, voice_time_s);
    return Voice(clip * push.joint_count, cursor.earlier, cursor.later, cursor.fraction, weight, 1, axis.first_row,
                 kVoiceBeginsLayer | kVoiceEndsLayer);
}

uint place_of_voice(uint index) { return (instance * push.voice_limit + index) * 4; }

void store_end(uint index, Voice voice) {
    voices[place_of_voice(index) + 3] = pack(uvec2(voice.reference_row, voice.flags));
}

void store_voice(uint index, Voice voice) {
    const uint at = place_of_voice(index);
    if ((push.flags & kPushTellsTimes) != 0) voice_times[instance * push.voice_limit + index] = voice_time_s;
    voices[at] = pack(uvec2(voice.first_track, voice.earlier));
    voices[at + 1] = pack(uvec2(voice.later, floatBitsToUint(voice.fraction)));
    voices[at + 2] = pack(floatBitsToUint(vec2(voice.weight, voice.layer_weight)));
    store_end(index, voice);
}

// Of a layer that has voices.
void begin_layer(LayerState state, ControlLayer layer, float weight) {
    layer_flags = (state.mode == kModeAdditive ? kVoiceAdditive : 0) |
                  (state.mask == kAbsent ? 0 : kVoiceMasked | state.mask << kVoiceMaskShift) | kVoiceBeginsLayer;
    const bool covers = layer_flags == kVoiceBeginsLayer && weight >= 1;
    if (layer.model_rotations != 0 && state.mode == kModeOverride) layer_flags |= kVoiceModelRotations;
    voices_layer_weight = weight;
    if (voice_count > 0 || covers) return;
    has_rest_pose = true;
    voice_count = 1;
}

void add_voice(uint clip, uint phase, float weight, bool ends_layer) {
    newest = voice_of(clip, phase, weight);
    newest.layer_weight = voices_layer_weight;
    newest.flags = layer_flags | (ends_layer ? kVoiceEndsLayer : 0);
    store_voice(voice_count, newest);
    layer_flags &= ~kVoiceBeginsLayer;
    ++voice_count;
}

// Only now is it known which voice is the last; and the rest pose is written here once, instead of once a layer.
void end_voices() {
    Voice rest_pose = voice_of(layout_of_group.clip_count, 0, 1);
    if (voice_count == 0) rest_pose.flags |= kVoiceEnds;
    if (voice_count == 0 || has_rest_pose) store_voice(0, rest_pose);
    newest.flags |= kVoiceEnds;
    if (voice_count > 0) store_end(voice_count - 1, newest);
}
