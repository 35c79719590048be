// A game without a picture until its end: waves of attackers walk to the middle of a field with things in their hands,
// die there, lie for a while and are gone, while others come. What a game does with a crowd in each of its frames, and
// how long these calls take.
//   game creature.glb guard.json lantern.glb picture.png
// (./run throng generate makes such files; examples/controllers has the controller)
#include <throng/throng.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <deque>
#include <map>
#include <numbers>
#include <random>
#include <vector>

using namespace throng;

namespace {

constexpr float kFrame_s = 1.0f / 60;
constexpr uint32_t kFrames = 900, kWaveEvery = 60, kWave = 250, kMost = 2000, kMostDying = 600, kMostAtOnce = 32;
constexpr double kFalls_s = 0.6, kLies_s = 1.5;

Affine scaled(float scale) { return {{{{scale, 0, 0, 0}, {0, scale, 0, 0}, {0, 0, scale, 0}}}}; }

struct Attacker {
    InstanceHandle body, thing;
    Affine world_from_model{};
};

struct Dying {
    InstanceHandle body;
    double gone_s = 0;
    std::vector<Trs<float>> pose{};  // that it showed when it began to fall; empty until that has come back
    double falls_s = 0;              // for so long already
};

class Game {
public:
    Game(const Device& device, const Character& body, const Controller& mind, const Character& thing)
        : body_(body),
          size_(length(body.bounds_max - body.bounds_min)),
          joint_from_thing_(scaled(0.2f * size_ / length(thing.bounds_max - thing.bounds_min))),
          crowd_(make_crowd(device, body, mind, thing)) {}

    // Returns how long its calls took, but for the update itself.
    double frame(uint32_t number) {
        const auto begin = std::chrono::steady_clock::now();
        if (number % kWaveEvery == 0) send_wave();
        hear();
        fight(number * double{kFrame_s});
        fall();
        watch();
        const std::chrono::duration<double, std::milli> calls = std::chrono::steady_clock::now() - begin;
        crowd_.update(kFrame_s).expect();
        return calls.count();
    }

    Crowd& crowd() { return crowd_; }
    uint32_t born = 0, died = 0, refused = 0, steps = 0, steps_of_the_gone = 0;

private:
    Crowd make_crowd(const Device& device, const Character& body, const Controller& mind,
                     const Character& thing) const {
        const CrowdGroup bodies{.character = &body,
                                .controller = &mind,
                                .sockets = {body.rig.joint_count() - 1},
                                .steering = Steering{.radius = 0.2f * size_,
                                                     .speed = 1.5f * size_,
                                                     .speed_parameter = mind.find_parameter("speed")},
                                .pose_capacity = kMostDying,
                                .capacity = kMost};
        const CrowdGroup things{.character = &thing, .capacity = kMost};
        return Crowd::create(
                   device, {.groups = {bodies, things}, .watch_capacity = kMost, .pose_request_capacity = kMostAtOnce})
            .expect();
    }

    // From all sides, as many as there is room for.
    void send_wave() {
        const uint32_t room = kMost - crowd_.alive_count(0).expect(), count = std::min(kWave, room);
        refused += kWave - count;
        std::vector<Affine> places;
        std::uniform_real_distribution<float> side(0, 6.2831853f), depth(20, 30);
        for (uint32_t i = 0; i < count; ++i) {
            const float angle = side(random_), distance = depth(random_) * size_;
            const float c = std::cos(angle), s = std::sin(angle);
            places.push_back({{{{-c, 0, -s, distance * s}, {0, 1, 0, 0}, {s, 0, -c, distance * c}}}});
        }
        const std::vector<InstanceHandle> bodies = crowd_.spawn(0, places).expect(),
                                          things = crowd_.spawn(1, places).expect();
        std::uniform_real_distribution<float> aside(-6, 6);
        std::vector<Vec3<float>> goals;
        for (uint32_t i = 0; i < count; ++i) {
            goals.push_back({aside(random_) * size_, 0, aside(random_) * size_});
            attackers_[bodies[i].instance] = {bodies[i], things[i], places[i]};
        }
        crowd_.set_destination(bodies, goals).expect();
        born += count;
    }

    // Where the attackers are, and the sound of their feet; as of some frames ago, since nothing waits for the GPU.
    void hear() {
        std::vector<InstanceHandle> things;
        std::vector<Affine> world_from_thing;
        for (const Feedback& feedback : crowd_.feedback().expect()) {
            for (const CharacterEvent& event : feedback.events)
                ++(crowd_.is_alive(event.instance) ? steps : steps_of_the_gone);
            for (const WatchedInstance& watched : feedback.watched) {
                const auto found = attackers_.find(watched.instance.instance);
                if (found == attackers_.end() || found->second.body != watched.instance) continue;
                found->second.world_from_model = watched.world_from_model;
                things.push_back(found->second.thing);
                world_from_thing.push_back(watched.sockets[0] * joint_from_thing_);
            }
            for (const ShownPose& shown : feedback.poses) {
                const auto found = std::ranges::find(dying_, shown.instance, &Dying::body);
                if (found != dying_.end())
                    found->pose.assign(shown.parent_from_joint.begin(), shown.parent_from_joint.end());
            }
        }
        crowd_.set_placement(things, world_from_thing).expect();
    }

    // An attacker near the middle may fall: it drops its thing, lies for a while, and is despawned. It goes on walking
    // until it is known what it looks like, a frame or two.
    void fight(double now_s) {
        std::uniform_real_distribution<float> chance(0, 1);
        std::vector<InstanceHandle> gone, hit;
        while (!dying_.empty() && dying_.front().gone_s <= now_s) {
            gone.push_back(dying_.front().body);
            dying_.pop_front();
        }
        std::erase_if(attackers_, [&](const auto& entry) {
            const Attacker& attacker = entry.second;
            const auto& row = attacker.world_from_model.row;
            const bool is_near = std::hypot(row[0][3], row[2][3]) < 12 * size_;
            if (!is_near || chance(random_) > 0.02f || dying_.size() == kMostDying || hit.size() == kMostAtOnce)
                return false;
            hit.push_back(attacker.body);
            dying_.push_back({attacker.body, now_s + kLies_s});
            gone.push_back(attacker.thing);
            ++died;
            return true;
        });
        crowd_.despawn(gone).expect();
        crowd_.clear_destination(hit).expect();
        crowd_.request_poses(hit).expect();
    }

    // On their backs, stiff; physics would be here instead.
    void fall() {
        std::vector<InstanceHandle> falling;
        std::vector<Trs<float>> poses;
        for (Dying& one : dying_) {
            if (one.pose.empty() || one.falls_s > kFalls_s) continue;
            const double part = std::min(one.falls_s / kFalls_s, 1.0), angle_rad = part * part * std::numbers::pi / 2;
            const Trs<double> back{.rotation = axis_angle(Vec3<double>{-1, 0, 0}, angle_rad)};
            falling.push_back(one.body);
            for (uint32_t joint = 0; joint < one.pose.size(); ++joint) {
                Trs<double> to = one.pose[joint].as<double>();
                if (body_.rig.parents[joint] == kNone) {
                    to.translation = transform_point(to_affine(back), to.translation);
                    to.rotation = back.rotation * to.rotation;
                }
                poses.push_back(to.as<float>());
            }
            one.falls_s += double{kFrame_s};
        }
        crowd_.set_pose(falling, poses).expect();
    }

    void watch() {
        std::vector<InstanceHandle> bodies;
        for (const auto& [instance, attacker] : attackers_) bodies.push_back(attacker.body);
        crowd_.watch(bodies).expect();
    }

    const Character& body_;
    float size_;
    Affine joint_from_thing_;
    Crowd crowd_;
    std::map<uint32_t, Attacker> attackers_;  // by the numbers of their bodies
    std::deque<Dying> dying_;
    std::mt19937 random_{1};
};

}  // namespace

int main(int argc, char** argv) {
    if (argc != 5) {
        std::fprintf(stderr, "usage: game creature.glb controller.json thing.glb picture.png\n");
        return 2;
    }
    const Character body = load_character(argv[1]).expect(), thing = load_character(argv[3]).expect();
    const Controller mind = load_controller(argv[2]).expect();
    const Device device = Device::create().expect();
    Game game(device, body, mind, thing);
    std::vector<double> calls_ms;
    for (uint32_t frame = 0; frame < kFrames; ++frame) calls_ms.push_back(game.frame(frame));
    std::ranges::sort(calls_ms);
    std::printf("%u attackers came, %u died, %u are there; %u found no room\n", game.born, game.died,
                game.crowd().alive_count(0).expect(), game.refused);
    std::printf("%u steps, and %u of attackers that had gone when they were heard\n", game.steps,
                game.steps_of_the_gone);
    std::printf("calls of a frame: median %.3f ms, worst %.3f ms\n", calls_ms[calls_ms.size() / 2], calls_ms.back());

    Renderer renderer = Renderer::create(device, {.width = 1280, .height = 720}).expect();
    const RenderResult result =
        renderer.render(game.crowd(), fit_camera(world_bounds(game.crowd()), 16.0f / 9)).expect();
    write_png(argv[4], result.picture).expect();
    return game.died > 0 && game.steps > 0 ? 0 : 1;
}
