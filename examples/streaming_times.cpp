// What it costs to bring characters into a running program. Times making a crowd, its first update and later ones; the
// same for a crowd of another character beside it, and for one of a character that is already on the device; then
// adding another crowd's group to the first crowd, and removing it again.
//   streaming_times [--device] one.glb other.glb ...   (--device: by the device's kernels, not natively)
#include "times.h"

#include <throng/throng.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <span>
#include <vector>

using namespace throng;

namespace {

template <class Work>
double milliseconds_of(const Work& work) {
    const Stopwatch stopwatch;
    work();
    return stopwatch.elapsed().clock_ms;
}

constexpr float kStep_s = 1.0f / 60;

Crowd make_crowd(const Device& device, std::span<const Character> characters, UpdatePath path) {
    constexpr uint32_t kOfEach = 500;
    CrowdSettings settings;
    settings.path = path;
    for (const Character& character : characters) settings.groups.push_back({&character, kOfEach});
    return Crowd::create(device, settings).expect();
}

// Returns the crowd, which keeps its characters on the device as long as it lives.
Crowd print_times(const char* name, const Device& device, std::span<const Character> characters, UpdatePath path) {
    Crowd crowd;
    const double create = milliseconds_of([&] { crowd = make_crowd(device, characters, path); });
    const auto update = [&] { crowd.update(kStep_s).expect(); };
    const double first = milliseconds_of(update);
    double later = first;
    for (int i = 0; i < 20; ++i) later = std::min(later, milliseconds_of(update));
    std::printf("%s: create %.1f ms, first update %.1f ms, later %.2f ms\n", name, create, first, later);
    return crowd;
}

}  // namespace

int main(int argc, char** argv) {
    const bool by_device = argc > 1 && std::strcmp(argv[1], "--device") == 0;
    const int first_file = by_device ? 2 : 1;
    if (argc < first_file + 2) {
        std::fprintf(stderr, "usage: streaming_times [--device] one.glb other.glb ...\n");
        return 2;
    }
    std::vector<Character> characters;
    for (int i = first_file; i < argc; ++i) characters.push_back(load_character(argv[i]).expect());
    const Device device = Device::create().expect();
    const UpdatePath path = by_device ? UpdatePath::kDevice : UpdatePath::kAuto;
    const std::span all(characters);
    Crowd running = print_times("all but the last", device, all.first(all.size() - 1), path);
    const Crowd streamed_in = print_times("the last beside them", device, all.last(1), path);
    print_times("the first once more", device, all.first(1), path);

    Crowd coming = make_crowd(device, all.last(1), path);
    GroupIndex group;
    const double add = milliseconds_of([&] { group = running.add_groups(std::move(coming)).expect()[0]; });
    const double first = milliseconds_of([&] { running.update(kStep_s).expect(); });
    const double remove = milliseconds_of([&] { running.remove_group(group).expect(); });
    const double next = milliseconds_of([&] { running.update(kStep_s).expect(); });
    std::printf("the last in one crowd with them: add %.2f ms, update %.2f ms; remove %.2f ms, update %.2f ms\n", add,
                first, remove, next);
}
