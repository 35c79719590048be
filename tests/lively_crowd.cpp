#include "tests/lively_crowd.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace throng::test {

Device native_device(DeviceSettings settings) {
    settings.select = "native";
    return *Device::create(settings);
}

Character walking_creature() {
    Character character = creature();
    for (Clip& clip : character.clips) {
        clip.first_root_row = static_cast<uint32_t>(character.root_rows.size());
        clip.root_row_count = 2;
        character.root_rows.insert(character.root_rows.end(), {{0, 0, 1, 0}, {0, 1.3f * clip.duration_s, 1, 0}});
    }
    return character;
}

LivelyCrowd::LivelyCrowd(uint32_t walking_count, uint32_t flying_count, uint32_t many_count)
    : first_walking(static_cast<uint32_t>(mixed.playbacks.size())),
      first_flying(first_walking + walking_count),
      first_of_many(first_flying + flying_count),
      instance_count(first_of_many + many_count) {
    settings.groups.push_back({.character = &walking,
                               .instance_count = walking_count,
                               .controller = &walker,
                               .sockets = {0, 7},
                               .socket_space = SocketSpace::kWorld});
    settings.groups.push_back({.character = &flying,
                               .instance_count = flying_count,
                               .controller = &dragon,
                               .sockets = {3},
                               .socket_space = SocketSpace::kModel});
    settings.groups.push_back({&mixed.characters[1], many_count});
    watched.resize(std::min(settings.watch_capacity, first_of_many - first_walking));
    const uint32_t end = first_of_many, begin = end - static_cast<uint32_t>(watched.size());
    for (uint32_t i = begin; i < end; ++i) watched[i - begin] = {i};
}

double LivelyCrowd::size_of(uint32_t instance) const {
    if (instance < first_walking) return mixed.character_of[instance]->size;
    if (instance < first_flying) return walking.size;
    return instance < first_of_many ? flying.size : mixed.characters[1].size;
}

Crowd LivelyCrowd::create_on(const Device& device, UpdatePath path) const {
    CrowdSettings on = settings;
    on.path = path;
    Crowd crowd = std::move(*Crowd::create(device, on));
    EXPECT_TRUE(crowd.watch(watched));
    return crowd;
}

void LivelyCrowd::update(Crowd& crowd, uint32_t update, const CrowdView* view) const {
    Random random(update);
    if (update % 16 == 0) {
        std::vector<Playback> playbacks;
        for (const Character* character : mixed.character_of) playbacks.push_back(random_playback(random, *character));
        EXPECT_TRUE(crowd.set_playback(Instances::numbered(0, static_cast<uint32_t>(playbacks.size())), playbacks));
        EXPECT_TRUE(crowd.set_playback(Instances::numbered(first_of_many, instance_count - first_of_many),
                                       random_playbacks(random, mixed.characters[1], instance_count - first_of_many)));
    }
    for (uint32_t i = first_walking; i < first_of_many; ++i) {
        const auto [parameter, value] = random_change(random, i < first_flying ? walker : dragon);
        EXPECT_TRUE(crowd.set_parameter(InstanceHandle{i}, parameter, value));
    }
    EXPECT_TRUE(crowd.update(static_cast<float>(random.between(0, 0.1)), view));
}

Feedback feedback_of(Crowd& crowd) {
    std::vector<Feedback> feedback = *crowd.feedback();
    EXPECT_EQ(feedback.size(), 1u);
    return std::move(feedback.at(0));
}

bool same_events(const Feedback& a, const Feedback& b, float max_apart_s) {
    return a.lost_event_count == b.lost_event_count &&
           std::ranges::equal(a.events, b.events, [&](const CharacterEvent& x, const CharacterEvent& y) {
               return x.instance == y.instance && x.event == y.event && x.layer == y.layer &&
                      std::abs(x.time_s - y.time_s) <= max_apart_s;
           });
}

CrowdView view_of_box(const Vec3<float>& middle, float half) {
    const float s = 1 / half;
    CrowdView view{.eye = middle + Vec3<float>{0, 4, 0} * half, .pixels = 100};
    view.clip_from_world = {
        {{s, 0, 0, -s * middle.x}, {0, 0, s, -s * middle.z}, {0, -s / 2, 0, s / 2 * middle.y + 0.5f}, {0, 0, 0, 1}}};
    return view;
}

void UpdateBits::add(std::span<const PlayedMotion> played) {
    for (const auto& [motion, phase, loops, fade, speed, loop] : played) {
        add(std::array{motion, loops, loop ? 1u : 0u});
        add(std::array{phase, fade, speed});
    }
}

void UpdateBits::add_results(Crowd& crowd) {
    for (const OutputBlock& block : crowd.outputs()) {
        add(block.host.skin);
        add(block.host.previous_skin);
        add(block.host.model);
        add(block.host.placement);
        add(block.host.socket);
        add(block.host.parameter);
        add(block.host.root);
        add(block.host.list);
        add(block.host.morph);
        add(block.host.skinned);
    }
}

void UpdateBits::add_feedback(Crowd& crowd) {
    const Feedback feedback = feedback_of(crowd);
    add(feedback.events);
    for (const WatchedInstance& one : feedback.watched) {
        add(one.parameters);
        add(one.sockets);
        for (const auto& layer : one.layers) add(layer);
    }
}

void UpdateBits::add_drawn(Crowd& crowd) {
    for (const DrawnInstance& one : drawn_of(crowd)) add(std::array{one.instance, one.lod});
}

std::vector<std::byte> bits_of(const LivelyCrowd& lively, const Device& device, UpdatePath path, uint32_t updates) {
    UpdateBits bits;
    Crowd crowd = lively.create_on(device, path);
    for (uint32_t update = 0; update < updates; ++update) {
        const CrowdView view = view_of_box({0, 0, static_cast<float>(update) - 5}, 6);
        lively.update(crowd, update, update % 2 == 0 ? nullptr : &view);
        bits.add_feedback(crowd);
        bits.add_drawn(crowd);
        bits.add_results(crowd);
    }
    return bits.all;
}

}  // namespace throng::test
