// Characters for tests of the native engine against the references.
#pragma once

#include "native/native.h"
#include "tests/shared.h"
#include "tests/test_rig.h"

#include <throng/throng.h>

#include <span>

namespace throng::test {

struct NamedCharacter {
    std::string name;
    Character character;
};
// The characters of shared/ if it exists, creatures of all kinds, and small rigs of all shapes, some with non-uniform
// scale. Each with exact and packed keys.
const std::vector<NamedCharacter>& native_characters();

// The cursors that the control stage computes for `playback`.
io::InstanceCursor cursor_of(const Character& character, const Playback& playback);
Playback random_playback(const Character& character, Random& random);

// Memory aligned to 64 bytes and filled with NaN, with guard words on both sides.
class GuardedBytes {
public:
    explicit GuardedBytes(size_t size);
    std::byte* data() { return bytes_.get() + kGuard; }
    std::span<const std::byte> content() const { return {bytes_.get() + kGuard, size_}; }
    ~GuardedBytes();  // fails the test where a guard word has changed

private:
    static constexpr size_t kGuard = 256;
    size_t size_;
    native::AlignedBytes bytes_;
};

// The largest displacement of a vertex, as a fraction of the character's size.
double displacement(const Character& character, std::span<const Affine> skin, const ReferencePose& wanted);

}  // namespace throng::test
