// What the fuzzers share: a native device, and a crowd of a character whose file may be hostile.
#pragma once

#include <throng/throng.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace throng::fuzz {

inline std::span<const std::byte> bytes_of(const uint8_t* data, size_t size) {
    return {reinterpret_cast<const std::byte*>(data), size};
}

[[noreturn]] void abort_with(std::string_view what, const Error& error);
// Aborts if the refusal is not one line without control characters.
void check_is_one_line(const Error& error);
// The same, and it must begin with the name of the input.
void check_refusal(const Error& error, std::string_view name);

// With one thread, so that an input always does the same.
Device& device();

// A compiled walker of few joints and four clips, made once.
const Character& small_walker();

// A controller of small_walker() with states, a blend space, an additive layer and one for play().
const Controller& walker_controller();

// A crowd of small_walker() with groups that do all that a native device computes: two clips, poses from outside and
// outfits; the controller, sockets, rules and agents; carried ones; and, if `shaders_populate`, commands that spawn.
Crowd make_crowd(bool shaders_populate);

// Some calls of each kind, then an update for a view, feedback and what can be read.
void use(Crowd& crowd, uint32_t update);

// Updates a small crowd of the character in all of its clips, with every output, and draws it.
void animate_and_draw(const Character& character);

}  // namespace throng::fuzz
