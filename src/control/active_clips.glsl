// The active clips of an instance, written as they come: step 9 of docs/controller.md. The includer declares
// `active_clips`, `active_clip_times`, `instance` and find_rows().

uint active_clip_count = 0;  // the rest pose included
bool has_rest_pose = false;  // below the others
ActiveClip newest;
float active_clip_time_s;  // of the clip of the last active_clip_of()
uint layer_flags;
float active_clips_layer_weight;

ActiveClip active_clip_of(uint clip, uint phase, float weight) {
    const ClipTimeline timeline = load_timeline(clip);
    active_clip_time_s = float(phase) * (1.0 / 4294967296.0) * timeline.duration_s;
    const SlotCursor cursor = find_rows(timeline, active_clip_time_s);
    return ActiveClip(clip * push.joint_count, cursor.earlier, cursor.later, cursor.fraction, weight, 1,
                      timeline.first_row, kActiveClipBeginsLayer | kActiveClipEndsLayer);
}

uint place_of_active_clip(uint index) { return (instance * push.active_clip_limit + index) * 4; }

void store_end(uint index, ActiveClip active_clip) {
    active_clips[place_of_active_clip(index) + 3] = pack(uvec2(active_clip.reference_row, active_clip.flags));
}

void store_active_clip(uint index, ActiveClip active_clip) {
    const uint at = place_of_active_clip(index);
    if ((push.flags & kPushTellsTimes) != 0)
        active_clip_times[instance * push.active_clip_limit + index] = active_clip_time_s;
    active_clips[at] = pack(uvec2(active_clip.first_track, active_clip.earlier));
    active_clips[at + 1] = pack(uvec2(active_clip.later, floatBitsToUint(active_clip.fraction)));
    active_clips[at + 2] = pack(floatBitsToUint(vec2(active_clip.weight, active_clip.layer_weight)));
    store_end(index, active_clip);
}

// Begins a layer that has active clips.
void begin_layer(LayerState state, ControlLayer layer, float weight) {
    layer_flags = (state.mode == kModeAdditive ? kActiveClipAdditive : 0) |
                  (state.mask == kNone ? 0 : kActiveClipMasked | state.mask << kActiveClipMaskShift) |
                  kActiveClipBeginsLayer;
    const bool covers = layer_flags == kActiveClipBeginsLayer && weight >= 1;
    if (layer.model_rotations != 0 && state.mode == kModeOverride) layer_flags |= kActiveClipModelRotations;
    active_clips_layer_weight = weight;
    if (active_clip_count > 0 || covers) return;
    has_rest_pose = true;
    active_clip_count = 1;
}

void add_active_clip(uint clip, uint phase, float weight, bool ends_layer) {
    newest = active_clip_of(clip, phase, weight);
    newest.layer_weight = active_clips_layer_weight;
    newest.flags = layer_flags | (ends_layer ? kActiveClipEndsLayer : 0);
    store_active_clip(active_clip_count, newest);
    layer_flags &= ~kActiveClipBeginsLayer;
    ++active_clip_count;
}

// Only now is it known which active clip is the last; and the rest pose is written here once, instead of once a layer.
void end_active_clips() {
    ActiveClip rest_pose = active_clip_of(layout_of_group.clip_count, 0, 1);
    if (active_clip_count == 0) rest_pose.flags |= kActiveClipEnds;
    if (active_clip_count == 0 || has_rest_pose) store_active_clip(0, rest_pose);
    newest.flags |= kActiveClipEnds;
    if (active_clip_count > 0) store_end(active_clip_count - 1, newest);
}
