// Crowds, what their instances play, and how far they are from the reference.
#pragma once

#include "tests/shared.h"
#include "tests/test_device.h"
#include "tests/test_rig.h"

#include <throng/draw.h>
#include <throng/reference.h>

#include <span>
#include <string>
#include <vector>

namespace throng::test {

inline constexpr double kPoseBound = 1e-5;  // of the character's size

// The number of colour bytes in which two pictures of the same size differ.
size_t different_bytes(const Picture& a, const Picture& b);

// Creates a crowd. Settings that a test leaves open come from the environment: THRONG_TEST_SCAN sets the scan method,
// and THRONG_TEST_PATH=device makes software devices, which would otherwise update natively, use shaders.
Crowd create(CrowdSettings settings);

// The last part of the name of a test that runs on several paths.
std::string path_name(const testing::TestParamInfo<UpdatePath>& of);

// The message of a call's error; empty where there is none.
std::string refusal(const auto& result) { return result ? std::string() : result.error().text(); }

// Copies can be compared and printed.
template <class T>
std::vector<T> copy_of(std::span<const T> values) {
    return {values.begin(), values.end()};
}
std::vector<std::vector<PlayedMotion>> copy_of(std::span<const std::span<const PlayedMotion>> layers);

// The instances that the last update has listed.
std::vector<DrawnInstance> drawn_of(Crowd& crowd);

Character creature(uint32_t joints = 60, uint32_t levels = 15, double error = 1e-4);

Character creature_with_lods();

Affine placed_at(float x, float y = 0, float z = 0);

// One of the controllers in examples/controllers.
Controller example(const char* name);

std::vector<ReferenceCharacter> references(const Character& character, const Controller& controller, uint32_t count);

// A random value for one of the controller's parameters.
struct ParameterChange {
    uint32_t parameter = 0;
    float value = 0;
};
ParameterChange random_change(Random& random, const Controller& controller);

Character small_character();

ClipPlayback random_slot(Random& random, const Character& character);

// Weights 0 and 1 are frequent in these.
Playback random_playback(Random& random, const Character& character);

std::vector<Playback> random_playbacks(Random& random, const Character& character, uint32_t count);

// The playback after an update: its times are wrapped or clamped when set, and again after the step.
Playback advanced(Playback playback, const Character& character, double step_s);

// Largest error of an instance as a fraction of the character's size.
double instance_error(Crowd& crowd, uint32_t instance, const Character& character, const Playback& playback,
                      bool with_model = false);

// The largest error of all joints' matrices and the skin matrices, measured as in matrix_error().
double model_error(Crowd& crowd, uint32_t instance, const ReferencePose& wanted, double size);

std::vector<Affine> skins_of(Crowd& crowd);

// Four characters and what each of their instances plays.
struct MixedCrowd {
    std::vector<Character> characters;
    CrowdSettings settings{.keep_model_matrices = true};
    std::vector<Playback> playbacks;
    std::vector<const Character*> character_of;  // [instance]

    explicit MixedCrowd(double scale_spread);
};

}  // namespace throng::test
