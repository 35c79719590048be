// A game that draws no picture until its end: waves of attackers of two kinds, in the colours of their teams, walk to
// the middle of a field with things in their hands, die there, lie for a while and disappear, while others arrive. It
// runs on its own Vulkan device with two frames in flight. Once a second a frame is dropped; beasts are loaded while
// the game runs; and it is saved and restored, after which the same things happen again. Prints how long its calls
// take.
//   game one.glb other.glb guard.json lantern.glb beast.glb picture.png [2000]
// (./run throng generate makes such files; examples/controllers has the controller; the number: most attackers at once)
#include "../frames.h"
#include "../times.h"

#include <throng/throng.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <span>
#include <vector>

using namespace throng;

namespace {

constexpr float kFrame_s = 1.0f / 60;
constexpr uint32_t kFrames = 600, kWaveEvery = 60, kMaxDying = 600, kMaxAtOnce = 32;
constexpr uint32_t kDropEvery = 60, kLoadAt = 150, kSaveAt = 400, kReplayed = 60, kBeasts = 20;
constexpr double kFalls_s = 0.6, kLies_s = 1.5;
constexpr uint32_t kKinds = 2, kThings = kKinds;  // groups: a kind of attackers each, then their things

Affine scaled(float scale) { return {{{{scale, 0, 0, 0}, {0, scale, 0, 0}, {0, 0, scale, 0}}}}; }

struct Attacker {
    uint32_t kind = 0;
    InstanceHandle body, thing;
    Affine world_from_model{};
};

struct Dying {
    uint32_t kind = 0;
    InstanceHandle body;
    double gone_s = 0;
    std::vector<Trs<float>> pose{};  // as it was shown when it began to fall; empty until it has come back
    double falls_s = 0;              // how long it has been falling
};

// What the game keeps besides its crowd.
struct World {
    std::map<uint32_t, Attacker> attackers;  // by the numbers of their bodies
    std::deque<Dying> dying;
    std::mt19937 random{1};
    uint64_t updates = 0;  // recorded, and not dropped
    uint32_t born = 0, died = 0, refused = 0, steps = 0, steps_of_the_gone = 0;
};

class Game {
public:
    Game(const Device& device, std::span<const Character> kinds, const Controller& mind, const Character& thing,
         uint32_t most)
        : most_(most), kinds_(kinds), thing_size_(thing.size), crowd_(make_crowd(device, mind, thing)) {}

    // Returns how long its calls took.
    Elapsed play(uint32_t frame) {
        const Stopwatch stopwatch;
        if (frame % kWaveEvery == 0) send_wave(frame / kWaveEvery);
        take_feedback(world.updates + 1 - std::min<uint64_t>(Frames::kInFlight, world.updates + 1));
        fight(frame * double{kFrame_s});
        fall();
        watch();
        return stopwatch.elapsed();
    }
    // Records the next update, which may still be dropped. Returns how long that took.
    Elapsed record(VkCommandBuffer commands) {
        const Stopwatch stopwatch;
        crowd_->record(commands, kFrame_s).expect();
        ++world.updates;
        return stopwatch.elapsed();
    }
    void drop() {
        crowd_->discard_last_record().expect();
        --world.updates;
    }

    struct Saved {
        std::vector<std::byte> crowd;
        World world;
    };
    // All frames must have finished. Uses the memory of `into` again.
    void save(Saved& into) {
        take_feedback(world.updates);
        const Stopwatch stopwatch;
        (*crowd_).save_state(into.crowd).expect();
        saving.push_back(stopwatch.elapsed());
        into.world = world;
    }
    void restore(const Saved& saved) {
        const Stopwatch stopwatch;
        (*crowd_).restore_state(saved.crowd).expect();
        restoring.push_back(stopwatch.elapsed());
        world = saved.world;
    }
    std::vector<Elapsed> saving, restoring;

    TimedCrowd& crowd() { return crowd_; }
    World world;

    // The settings of a crowd whose groups can be added to the game's crowd.
    static CrowdSettings settings_with(std::vector<CrowdGroup> groups, uint32_t watch_capacity = 0) {
        return {.groups = std::move(groups),
                .frames_in_flight = Frames::kInFlight,
                .culling = Culling{},
                .watch_capacity = watch_capacity,
                .pose_request_capacity = kMaxAtOnce};
    }

private:
    Crowd make_crowd(const Device& device, const Controller& mind, const Character& thing) const {
        std::vector<CrowdGroup> groups;
        for (const Character& body : kinds_)
            groups.push_back({.character = &body,
                              .controller = &mind,
                              .sockets = {body.rig.joint_count() - 1},
                              .steering = Steering{.radius = 0.2f * body.size,
                                                   .speed = 1.5f * body.size,
                                                   .speed_parameter = mind.parameter_named("speed").expect()},
                              .pose_capacity = kMaxDying,
                              .capacity = most_ / kKinds,
                              .outfits = {{}, {armoured(body)}}});
        groups.push_back({.character = &thing, .is_carried = true, .capacity = most_});
        return Crowd::create(device, settings_with(std::move(groups), most_)).expect();
    }

    // Steel all over, with a little of the team's colour.
    static Outfit armoured(const Character& body) {
        Outfit outfit;
        for (uint32_t section = 0; section < body.sections.size(); ++section)
            outfit.sections.push_back({.section = section, .color = {0.6f, 0.65f, 0.7f}, .tint = 0.3f});
        return outfit;
    }

    // Attackers of one kind come from all sides, as many as there is room for. Each wave has a colour, and one in four
    // attackers is armoured.
    void send_wave(uint32_t wave) {
        const uint32_t kind = wave % kKinds, room = most_ / kKinds - crowd_->alive_count(kind).expect(),
                       wave_size = most_ / 5, count = std::min(wave_size, room);
        const float size = kinds_[kind].size;
        world.refused += wave_size - count;
        std::vector<Affine> places;
        std::uniform_real_distribution<float> side(0, 6.2831853f), depth(20, 30);
        for (uint32_t i = 0; i < count; ++i) {
            const float angle = side(world.random), distance = depth(world.random) * size;
            const float c = std::cos(angle), s = std::sin(angle);
            places.push_back({{{{-c, 0, -s, distance * s}, {0, 1, 0, 0}, {s, 0, -c, distance * c}}}});
        }
        const std::vector<InstanceHandle> bodies = crowd_->spawn(kind, places).expect(),
                                          things = crowd_->spawn(kThings, places).expect();
        std::uniform_real_distribution<float> aside(-6, 6);
        std::vector<Vec3<float>> goals;
        std::vector<InstanceLook> looks;
        std::vector<Attachment> hands;
        constexpr std::array<std::array<float, 3>, 3> kTeams{{{1, 0.4f, 0.3f}, {0.4f, 0.6f, 1}, {0.9f, 0.8f, 0.3f}}};
        for (uint32_t i = 0; i < count; ++i) {
            goals.push_back({aside(world.random) * size, 0, aside(world.random) * size});
            looks.push_back({.tint = kTeams[wave % kTeams.size()], .outfit = i % 4 == 0 ? 1u : 0u});
            hands.push_back({.carrier = bodies[i], .socket_from_model = scaled(0.2f * size / thing_size_)});
            world.attackers[bodies[i].instance] = {kind, bodies[i], things[i], places[i]};
        }
        crowd_->set_destination(bodies, goals).expect();
        crowd_->set_look(bodies, looks).expect();
        crowd_->attach(things, hands).expect();
        world.born += count;
    }

    // Takes in where the attackers are, and the sound of their feet, up to this update. It lies some frames back, since
    // nothing waits for the GPU. Feedback of later updates is kept, so that a restored game hears the same at the same
    // time.
    void take_feedback(uint64_t update) {
        for (Feedback& feedback : crowd_->feedback().expect()) pending_.push_back(std::move(feedback));
        for (; !pending_.empty() && pending_.front().update <= update; pending_.pop_front()) {
            const Feedback& feedback = pending_.front();
            for (const CharacterEvent& event : feedback.events)
                ++((*crowd_).is_alive(event.instance) ? world.steps : world.steps_of_the_gone);
            for (const WatchedInstance& watched : feedback.watched) {
                const auto found = world.attackers.find(watched.instance.instance);
                if (found == world.attackers.end() || found->second.body != watched.instance) continue;
                found->second.world_from_model = watched.world_from_model;
            }
            for (const ShownPose& shown : feedback.poses) {
                const auto found = std::ranges::find(world.dying, shown.instance, &Dying::body);
                if (found != world.dying.end())
                    found->pose.assign(shown.parent_from_joint.begin(), shown.parent_from_joint.end());
            }
        }
    }

    // An attacker near the middle may be hit: it drops its thing, falls, lies for a while, and is despawned. It keeps
    // walking until its pose has come back, a frame or two later.
    void fight(double now_s) {
        std::uniform_real_distribution<float> chance(0, 1);
        std::vector<InstanceHandle> gone, hit;
        while (!world.dying.empty() && world.dying.front().gone_s <= now_s) {
            gone.push_back(world.dying.front().body);
            world.dying.pop_front();
        }
        std::erase_if(world.attackers, [&](const auto& entry) {
            const Attacker& attacker = entry.second;
            const auto& row = attacker.world_from_model.row;
            const bool is_near = std::hypot(row[0][3], row[2][3]) < 12 * kinds_[attacker.kind].size;
            if (!is_near || chance(world.random) > 0.02f || world.dying.size() == kMaxDying || hit.size() == kMaxAtOnce)
                return false;
            hit.push_back(attacker.body);
            world.dying.push_back({attacker.kind, attacker.body, now_s + kLies_s});
            gone.push_back(attacker.thing);
            ++world.died;
            return true;
        });
        crowd_->despawn(gone).expect();
        crowd_->clear_destination(hit).expect();
        crowd_->request_poses(hit).expect();
    }

    // The attackers that were hit fall on their backs, stiff; a real game would have physics here instead.
    void fall() {
        std::array<std::vector<InstanceHandle>, kKinds> falling;
        std::array<std::vector<Trs<float>>, kKinds> poses;
        for (Dying& one : world.dying) {
            if (one.pose.empty() || one.falls_s > kFalls_s) continue;
            const double part = std::min(one.falls_s / kFalls_s, 1.0), angle_rad = part * part * std::numbers::pi / 2;
            const Trs<double> back{.rotation = axis_angle(Vec3<double>{-1, 0, 0}, angle_rad)};
            falling[one.kind].push_back(one.body);
            for (uint32_t joint = 0; joint < one.pose.size(); ++joint) {
                Trs<double> to = one.pose[joint].as<double>();
                if (kinds_[one.kind].rig.parents[joint] == kNone) {
                    to.translation = transform_point(to_affine(back), to.translation);
                    to.rotation = back.rotation * to.rotation;
                }
                poses[one.kind].push_back(to.as<float>());
            }
            one.falls_s += double{kFrame_s};
        }
        for (uint32_t kind = 0; kind < kKinds; ++kind) crowd_->set_pose(falling[kind], poses[kind]).expect();
    }

    void watch() {
        std::vector<InstanceHandle> bodies;
        for (const auto& [instance, attacker] : world.attackers) bodies.push_back(attacker.body);
        crowd_->watch(bodies).expect();
    }

    uint32_t most_;
    std::span<const Character> kinds_;  // [kKinds]
    float thing_size_;
    TimedCrowd crowd_;
    std::deque<Feedback> pending_;
};

// Beasts that stand around. Their own thread loads them, and records the commands that upload them to the device.
struct Beasts {
    Beasts(const Device& device, const AdoptedDevice& vulkan, const char* file)
        : character(load_character(file).expect()), uploads(vulkan) {
        crowd = Crowd::create(device, Game::settings_with({{&character, kBeasts}})).expect();
        std::vector<Affine> places;
        for (uint32_t i = 0; i < kBeasts; ++i)
            places.push_back(to_affine(
                Trs<float>{.translation = {1.5f * character.size * (static_cast<float>(i) - kBeasts / 2.0f), 0, 0}}));
        crowd.set_placement(crowd.instances(), places).expect();
        crowd.set_playback(crowd.instances(), {.first = {.clip = 0}}).expect();
        device.warm_up().expect();
        crowd.record_uploads(uploads.begin()).expect();
        commands = uploads.end();
    }

    Character character;
    OwnCommands uploads;
    Crowd crowd;
    VkCommandBuffer commands = VK_NULL_HANDLE;  // to be submitted before the first update
};

// Runs a number of frames of the game.
class Loop {
public:
    // `load` makes the beasts, on another thread.
    Loop(Game& game, Frames& frames, std::function<std::unique_ptr<Beasts>()> load)
        : game_(game), frames_(frames), load_(std::move(load)) {}

    void run(uint32_t first, uint32_t end) {
        for (uint32_t frame = first; frame < end; ++frame) {
            if (frame == kLoadAt && !loading_.valid() && !beasts_) loading_ = std::async(std::launch::async, load_);
            const VkCommandBuffer commands = frames_.begin();
            const Stopwatch stopwatch;
            const bool was_loading = loading_.valid();
            VkCommandBuffer of_beasts = VK_NULL_HANDLE;
            // A saved state can be restored only into a crowd with the same groups
            const bool is_replayed = frame >= kSaveAt && frame < kSaveAt + kReplayed;
            if (was_loading && !is_replayed &&
                loading_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
                beasts_ = loading_.get();
                of_beasts = beasts_->commands;
                const Stopwatch joins;
                game_.crowd()->add_groups(std::move(beasts_->crowd)).expect();
                joining.push_back(joins.elapsed());
            }
            calls.push_back(game_.play(frame));
            records.push_back(game_.record(commands));
            if (!of_beasts && frame % kDropEvery == kDropEvery / 2) {
                game_.drop();
                frames_.drop();
                continue;
            }
            frames_.submit(of_beasts);
            (was_loading ? while_loading : otherwise).push_back(stopwatch.elapsed());
        }
        frames_.finish();
    }

    // Waits until the beasts are loaded, so that the next frame takes them in. Nothing holds this game to 60 frames a
    // second, so on a fast device all frames before that take less time than loading.
    void wait_for_beasts() const {
        if (loading_.valid()) loading_.wait();
    }
    bool has_beasts() const { return beasts_ != nullptr; }
    std::vector<Elapsed> calls, records, joining, while_loading, otherwise;

private:
    Game& game_;
    Frames& frames_;
    std::function<std::unique_ptr<Beasts>()> load_;
    std::future<std::unique_ptr<Beasts>> loading_;
    std::unique_ptr<Beasts> beasts_;
};

}  // namespace

int main(int argc, char** argv) {
    const int most = argc == 8 ? std::atoi(argv[7]) : 2000;
    if (argc < 7 || argc > 8 || most < 5 || most > 100'000) {
        std::fprintf(stderr, "usage: game one.glb other.glb controller.json thing.glb beast.glb picture.png [COUNT]\n");
        return 2;
    }
    Cleanup cleanup;  // first, so that Vulkan outlives all that throng has made with it
    const AdoptedDevice vulkan = open_vulkan(cleanup, "game");
    Frames frames(vulkan, cleanup);
    const Device device = Device::adopt(vulkan).expect();
    const std::array kinds{load_character(argv[1]).expect(), load_character(argv[2]).expect()};
    const Controller mind = load_controller(argv[3]).expect();
    const Character thing = load_character(argv[4]).expect();
    Game game(device, kinds, mind, thing, static_cast<uint32_t>(most));
    // Before anybody plays: compile what some devices compile late, run the first update, which uploads everything, and
    // get memory for states
    device.warm_up().expect();
    game.record(frames.begin());
    frames.submit();
    frames.finish();
    Game::Saved saved, later, again;
    for (Game::Saved* const state : {&saved, &later, &again}) game.save(*state);
    game.saving.clear();
    Loop loop(game, frames, [&] { return std::make_unique<Beasts>(device, vulkan, argv[5]); });
    loop.run(0, kSaveAt);
    game.save(saved);
    loop.run(kSaveAt, kSaveAt + kReplayed);
    game.save(later);
    game.restore(saved);
    loop.run(kSaveAt, kSaveAt + kReplayed);
    game.save(again);
    const bool is_same = again.crowd == later.crowd && again.world.died == later.world.died;
    loop.wait_for_beasts();
    loop.run(kSaveAt + kReplayed, kFrames);

    const World& world = game.world;
    std::printf("%u attackers came, %u died, %zu still walk; %u found no room\n", world.born, world.died,
                world.attackers.size(), world.refused);
    std::printf("%u steps, and %u of attackers that were gone when the feedback arrived\n", world.steps,
                world.steps_of_the_gone);
    std::printf("saved in %zu bytes; restored, the same %u frames %s\n", saved.crowd.size(), kReplayed,
                is_same ? "gave the same bytes" : "gave OTHER bytes");
    std::printf("%28s  %-28s  by the clock\n", "ms", "of the game's thread alone");
    print("record() of a frame:", loop.records);
    print("other calls of a frame:", loop.calls);
    print("any one of these calls:", game.crowd().calls);
    print("a frame, all of it:", loop.otherwise);
    print("a frame while beasts load:", loop.while_loading);
    print("adding them to the crowd:", loop.joining);
    print("save_state():", game.saving);
    print("restore_state():", game.restoring);

    Renderer renderer = Renderer::create(device, {.width = 1280, .height = 720}).expect();
    const Camera camera = fit_camera(main_bounds(*game.crowd()), 16.0f / 9);
    write_png(argv[6], renderer.render(*game.crowd(), camera).expect().picture).expect();
    return is_same && loop.has_beasts() && world.died > 0 && world.steps > 0 ? 0 : 1;
}
