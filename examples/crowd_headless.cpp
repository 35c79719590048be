// A crowd without a picture: two kinds of characters, each individual with its own clips, speed and blend, two seconds
// of animation on the GPU, and one individual's matrices read back, as a server or an offline tool would do it.
//   crowd_headless one.glb other.glb
#include <throng/throng.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

using namespace throng;

namespace {

// What individual `i` plays: two neighbouring clips of the file, started at a time and played at a speed of its own,
// blended a little differently from everyone else's.
Playback playback_of(const Character& character, uint32_t i) {
    const auto clip_count = static_cast<uint32_t>(character.clips.size());
    if (clip_count == 0) return {};  // the rest pose
    return {
        .first = {.clip = i % clip_count, .time_s = 0.37 * i, .speed = 0.8f + 0.1f * static_cast<float>(i % 5)},
        .second = {.clip = (i + 1) % clip_count, .time_s = 0.11 * i},
        .weight = static_cast<float>(i % 4) / 3,  // 1: the first clip alone; 0: the second alone
    };
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: crowd_headless one.glb other.glb\n");
        return 2;
    }

    // Reading and compiling a file needs no GPU. A Character is plain arrays: look at it as you like.
    const Character one = load_character(argv[1]).expect();
    const Character other = load_character(argv[2]).expect();

    // By default a hardware GPU if there is one, else the software device.
    const Device device = Device::create().expect();
    std::printf("%s, %s\n", device.info().name.c_str(), device.info().driver.c_str());

    // A crowd has a group for each character; its individuals are numbered group after group: 0-299 and 300-499. The
    // matrices of the joints themselves, which most programs do not need, are kept only on request.
    Crowd crowd = Crowd::create(device, {.groups = {{&one, 300}, {&other, 200}}, .keep_model_matrices = true}).expect();
    std::vector<Playback> playback;
    for (uint32_t i = 0; i < 300; ++i) playback.push_back(playback_of(one, i));
    for (uint32_t i = 0; i < 200; ++i) playback.push_back(playback_of(other, i));
    crowd.set_playback(crowd.instances(), playback).expect();

    // From here on nothing is uploaded: the GPU advances the clocks itself.
    StageTimes sum;
    constexpr int kFrames = 120;
    for (int frame = 0; frame < kFrames; ++frame) {
        crowd.update(1.0f / 60).expect();
        const StageTimes times = crowd.stage_times().expect();
        for (size_t stage = 0; stage < times.ms.size(); ++stage) sum.ms[stage] += times.ms[stage];
    }
    std::printf("%u characters, mean of %d updates:", crowd.instance_count(), kFrames);
    for (size_t stage = 0; stage < stage_names().size(); ++stage)
        if (sum.ms[stage] > 0) std::printf(" %s %.3f ms,", stage_names()[stage], sum.ms[stage] / kFrames);
    std::printf(" total %.3f ms\n", sum.total() / kFrames);

    // One individual's joints in model space; a joint's position is the last column of its matrix.
    constexpr uint32_t kIndividual = 301;
    const std::vector<Affine> joints = crowd.read_model_matrices({kIndividual}).expect();
    const auto height = [](const Affine& model_from_joint) { return model_from_joint.row[1][3]; };
    const auto highest = std::max_element(joints.begin(), joints.end(),
                                          [&](const auto& a, const auto& b) { return height(a) < height(b); });
    const auto joint = static_cast<size_t>(highest - joints.begin());
    std::printf("%s number %u: the highest joint is %zu, '%s', at a height of %.3f\n", other.name.c_str(), kIndividual,
                joint, other.rig.names[joint].c_str(), static_cast<double>(height(*highest)));

    // Its skin matrices are the joints' matrices times the file's inverse bind matrices: what a vertex shader wants.
    const std::vector<Affine> skin = crowd.read_skin_matrices({kIndividual}).expect();
    float difference = 0;
    for (size_t entry = 0; entry < skin.size(); ++entry) {
        const PaletteEntry& palette = other.palette[entry];
        const Affine expected = joints[palette.joint] * palette.joint_from_bind;
        for (size_t row = 0; row < 3; ++row)
            for (size_t column = 0; column < 4; ++column)
                difference = std::max(difference, std::abs(skin[entry].row[row][column] - expected.row[row][column]));
    }
    std::printf("its %zu skin matrices differ by at most %.1e from the product computed here\n", skin.size(),
                static_cast<double>(difference));
    return difference < 1e-4f * std::max(1.0f, other.size) ? 0 : 1;
}
