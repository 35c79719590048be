// Writes the active clips of an instance one after another: step 9 of docs/controller.md. The includer declares
// `active_clips`, `active_clip_times`, `instance` and find_rows().

uint active_clip_count = 0;   // the rest pose included
bool has_rest_pose = false;   // below the others
uvec2 newest_end = uvec2(0);  // reference_row and flags of the newest one: stored once it is known what follows
uint layer_flags = 0;
float active_clips_layer_weight = 0;

uint place_of_active_clip(uint index) { return (instance * push.active_clip_limit + index) * 4; }

void store_end(uint index, uvec2 end) { active_clips[place_of_active_clip(index) + 3] = pack(end); }

// Stores all of an active clip except its reference_row and flags. `weights`: the clip's within its layer, then the
// layer's.
void store_begin(uint index, ClipCursor cursor, vec2 weights, float time_s) {
    const uint at = place_of_active_clip(index);
    if ((push.flags & kPushTellsTimes) != 0) active_clip_times[instance * push.active_clip_limit + index] = time_s;
    active_clips[at] = pack(uvec2(cursor.first_track, cursor.earlier));
    active_clips[at + 1] = pack(uvec2(cursor.later, floatBitsToUint(cursor.fraction)));
    active_clips[at + 2] = pack(floatBitsToUint(weights));
}

// Stores the end of the newest active clip, if there is one, now that its flags are known.
void end_newest(uint flags) {
    if (active_clip_count > (has_rest_pose ? 1 : 0)) store_end(active_clip_count - 1, newest_end | uvec2(0, flags));
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

void add_active_clip(uint clip, uint phase, float weight) {
    end_newest((layer_flags & kActiveClipBeginsLayer) != 0 ? kActiveClipEndsLayer : 0);
    const ClipTimeline timeline = load_timeline(clip);
    const float time_s = float(phase) * (1.0 / 4294967296.0) * timeline.duration_s;
    ClipCursor cursor = find_rows(timeline, time_s);
    cursor.first_track = clip * push.joint_count;
    store_begin(active_clip_count, cursor, vec2(weight, active_clips_layer_weight), time_s);
    newest_end = uvec2(timeline.first_row, layer_flags);
    layer_flags &= ~kActiveClipBeginsLayer;
    ++active_clip_count;
}

// Ends the list. If the rest pose, a clip of one row, lies below the layers, it is written here, once, instead of in
// each layer.
void end_active_clips() {
    end_newest(kActiveClipEndsLayer | kActiveClipEnds);
    if (active_clip_count > 0 && !has_rest_pose) return;
    const uint clip = layout_of_group.clip_count, row = load_timeline(clip).first_row;
    store_begin(0, ClipCursor(clip * push.joint_count, row, row, 0), vec2(1), 0);
    store_end(
        0, uvec2(row, kActiveClipBeginsLayer | kActiveClipEndsLayer | (active_clip_count == 0 ? kActiveClipEnds : 0)));
}
