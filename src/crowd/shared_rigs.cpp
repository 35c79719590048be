#include "crowd/shared_rigs.h"

#include "gpu/shared_buffers.h"

#include <span>

namespace throng {

// Checksums of everything that rows and native rigs depend on.
const SharedValues::Key& SharedRigs::motion(const Character& character) {
    const auto [entry, is_new] = motions_.try_emplace(&character);
    SharedValues::Key& key = entry->second;
    if (!is_new) return key;
    const auto add = [&](const auto& values) {
        using T = std::ranges::range_value_t<decltype(values)>;
        static_assert(std::is_trivially_copyable_v<T>);
        const auto [crc, hash, size_bytes, usage, texel_bytes] = SharedBuffers::key_of(std::as_bytes(std::span(values)),
                                                                                       0, 0);
        key.insert(key.end(), {crc, hash, size_bytes});
    };
    std::vector<uint32_t> clips;
    for (const Clip& clip : character.clips)
        clips.insert(clips.end(), {clip.first_time, clip.row_count, clip.row_stride, clip.first_row});
    add(clips);
    add(std::vector{character.size, character.packed ? 1.0f : 0.0f});
    add(character.rig.parents);
    add(character.rig.rest);
    add(character.times_s);
    add(character.keys);
    add(character.words);
    add(character.tracks);
    add(character.palette);
    add(character.joint_lods);
    // Errors of rows are bounded by how far the skin reaches from its joints
    add(character.sections);
    add(character.vertices);
    add(character.influences);
    return key;
}

const SharedImages& SharedRigs::images(const Character& character) {
    const auto [entry, is_new] = images_.try_emplace(&character);
    if (is_new) entry->second = shared_images(*gpu_, character.images);
    return entry->second;
}

SharedValues::Key SharedRigs::key_of(SharedValue kind, const Character& character) {
    SharedValues::Key key = motion(character);
    key.insert(key.begin(), uint64_t(kind));
    return key;
}

std::shared_ptr<const NativeRig> SharedRigs::native(const Character& character, const NativeRigSettings& settings) {
    SharedValues::Key key = key_of(SharedValue::kNativeRig, character);
    key.insert(key.end(), {settings.lod, settings.keeps_model, settings.sockets_only, settings.all_move});
    key.insert(key.end(), settings.sockets.begin(), settings.sockets.end());
    return made_.emplace_back(gpu_->values.get<NativeRig>(key, [&] { return NativeRig(character, settings); }));
}

}  // namespace throng
