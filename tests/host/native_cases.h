// Characters, and what the native engine makes of them beside what the references do.
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
// Those of the folder shared/ where it is there, creatures of all kinds, and small ones of all shapes, some with three
// scales; each with exact and packed keys.
const std::vector<NamedCharacter>& native_characters();

// What `playback` has as the control stage's cursors.
io::InstanceCursor cursor_of(const Character& character, const Playback& playback);
Playback random_playback(const Character& character, Random& random);

// Memory at a multiple of 64 bytes with guard words on both sides, filled with NaN.
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

// The largest displacement of a vertex, parts of the character's size.
double displacement(const Character& character, std::span<const Affine> skin, const ReferencePose& wanted);

}  // namespace throng::test
