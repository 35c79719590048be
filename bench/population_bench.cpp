#include "bench/population_bench.h"

#include "bench/updates.h"
#include "bench/value_of.h"

#include <throng/reference.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <random>

namespace throng::bench {
namespace {

constexpr std::array kParts{0.1, 0.5, 1.0};

enum class Kind { kForGood, kTogether, kAnywhere };
constexpr std::array kKindNames{"for good", "together", "anywhere"};

struct PopulationEntrant {
    Kind kind = Kind::kForGood;
    uint32_t count = 0;
    Crowd crowd;
    std::vector<InstanceHandle> instances;
    double max_error = 0;
    UpdateTimes times;
};

// Frames in which many instances change, and how they change.
struct Turnover {
    const char* name = "";
    std::function<void()> change;
    std::vector<double> call_ms, update_ms;
};

class PopulationMeasurement {
public:
    PopulationMeasurement(const Device& device, const PopulationCase& population)
        : device_(device),
          load_(device.gpu()),
          population_(population),
          capacity_(static_cast<uint32_t>(population.playback.size())) {}

    void check(const Progress& progress) {
        for (const double part : kParts)
            for (const Kind kind : {Kind::kForGood, Kind::kTogether, Kind::kAnywhere}) {
                const auto count = std::max(1u, static_cast<uint32_t>(part * capacity_));
                progress(population_.configuration + ": checking " + std::to_string(count));
                PopulationEntrant& entrant = entrants_.emplace_back(make(kind, count));
                value_of(entrant.crowd.update(0));
                entrant.max_error = largest_error_of_some(count, [&](uint32_t i) { return error_of(entrant, i); });
            }
    }

    void time(uint32_t samples, const Progress& progress) {
        std::vector<Contestant> contestants;
        for (PopulationEntrant& entrant : entrants_)
            if (!is_wrong(entrant))
                contestants.push_back({population_.configuration + ": " + std::to_string(entrant.count),
                                       [&] { entrant.times.take(load_, entrant.crowd); }});
        run_rounds(contestants, samples, progress);
    }

    // Times crowds that fill half of their capacity; half of their instances change in each frame.
    void time_turnover(uint32_t samples, const Progress& progress) {
        PopulationEntrant told = make(Kind::kAnywhere, std::max(1u, capacity_ / 2)),
                          reborn = make(Kind::kAnywhere, std::max(1u, capacity_ / 2));
        changed_count_ = std::max(1u, capacity_ / 4);
        std::mt19937 random(2);
        PopulationEntrant commanded = make_commanded();
        commands_are_wrong_ = is_wrong(commanded);
        turnovers_ = {Turnover{"playbacks", [&] { tell(told, random); }, {}, {}},
                      Turnover{"births and deaths", [&] { replace(reborn, random); }, {}, {}},
                      Turnover{"by shaders", [&] { command(commanded, random); }, {}, {}}};
        const std::array crowds{&told.crowd, &reborn.crowd, &commanded.crowd};
        std::vector<Contestant> contestants;
        for (size_t i = 0; i < turnovers_.size(); ++i) {
            Turnover& turnover = turnovers_[i];
            Crowd& crowd = *crowds[i];
            value_of(crowd.update(0));
            contestants.push_back({population_.configuration + ": " + turnover.name, [&turnover, &crowd] {
                                       const Stopwatch calls;
                                       turnover.change();
                                       turnover.call_ms.push_back(calls.elapsed_s() * 1e3);
                                       const Stopwatch update;
                                       value_of(crowd.update(kFrame_s));
                                       turnover.update_ms.push_back(update.elapsed_s() * 1e3);
                                   }});
        }
        run_rounds(contestants, samples, progress);
    }

    std::vector<Json> records() const {
        std::vector<Json> all;
        for (const PopulationEntrant& entrant : entrants_) all.push_back(record_of(entrant));
        for (const Turnover& turnover : turnovers_) {
            Json record = new_record(entrants_.front().crowd);
            record.update({{"frames_with", turnover.name},
                           {"characters", std::max(1u, capacity_ / 2)},
                           {"changed", changed_count_},
                           {"samples", turnover.call_ms.size()},
                           {"call_ms", spread_json(spread_of(turnover.call_ms))},
                           {"update_ms", spread_json(spread_of(turnover.update_ms))}});
            if (commands_are_wrong_ && &turnover == &turnovers_.back()) record["wrong"] = true;
            all.push_back(record);
        }
        return all;
    }

private:
    // The n-th instance of each entrant plays and stands as the n-th of the case.
    PopulationEntrant make(Kind kind, uint32_t count) const {
        CrowdGroup group{.character = population_.character};
        if (kind == Kind::kForGood)
            group.instance_count = count;
        else
            group.capacity = capacity_;
        PopulationEntrant entrant{
            kind,
            count,
            value_of(Crowd::create(device_, {.groups = {group}, .path = population_.path, .culling = Culling{}})),
            {},
            0,
            {}};
        Crowd& crowd = entrant.crowd;
        if (kind == Kind::kForGood) {
            for (uint32_t i = 0; i < count; ++i) entrant.instances.push_back({.instance = i});
            value_of(crowd.set_placement(crowd.instances(), population_.placement.first(count)));
        } else {
            const uint32_t born = kind == Kind::kAnywhere ? capacity_ : count;
            entrant.instances = value_of(crowd.spawn(0, population_.placement.first(born)));
            std::shuffle(entrant.instances.begin(), entrant.instances.end(), std::mt19937(1));
            value_of(crowd.despawn(std::span(entrant.instances).subspan(count)));
            entrant.instances.resize(count);
        }
        value_of(crowd.set_placement(entrant.instances, population_.placement.first(count)));
        value_of(crowd.set_playback(entrant.instances, population_.playback.first(count)));
        return entrant;
    }

    double error_of(PopulationEntrant& entrant, uint32_t i) const {
        return skin_error(value_of(entrant.crowd.read_skin_matrices(entrant.instances[i])),
                          value_of(reference_pose(*population_.character, population_.playback[i])).model_from_bind,
                          population_.character->size);
    }
    static bool is_wrong(const PopulationEntrant& entrant) { return !(entrant.max_error <= kSkinErrorBound); }

    // Moves the instances to be changed, chosen at random, to the end of the list.
    void choose(PopulationEntrant& entrant, std::mt19937& random) const {
        const auto count = static_cast<uint32_t>(entrant.instances.size());
        for (uint32_t i = 0; i < changed_count_; ++i)
            std::swap(entrant.instances[count - 1 - i],
                      entrant.instances[std::uniform_int_distribution<uint32_t>(0, count - 1 - i)(random)]);
    }

    void tell(PopulationEntrant& entrant, std::mt19937& random) const {
        choose(entrant, random);
        set_playback(entrant);
    }

    void replace(PopulationEntrant& entrant, std::mt19937& random) const {
        choose(entrant, random);
        const uint32_t kept = entrant.count - changed_count_;
        value_of(entrant.crowd.despawn(std::span(entrant.instances).subspan(kept)));
        const std::vector<InstanceHandle> born = value_of(
            entrant.crowd.spawn(0, population_.placement.subspan(kept, changed_count_)));
        std::ranges::copy(born, entrant.instances.begin() + kept);
        set_playback(entrant);
    }

    // Sets the playback of the instances at the end of the list.
    void set_playback(PopulationEntrant& entrant) const {
        const uint32_t kept = entrant.count - changed_count_;
        value_of(entrant.crowd.set_playback(std::span(entrant.instances).subspan(kept),
                                            population_.playback.subspan(kept, changed_count_)));
    }

    // Like make(), but spawns the instances by commands, as shaders do, at a random half of the instance numbers.
    PopulationEntrant make_commanded() const {
        const CrowdGroup group{.character = population_.character,
                               .capacity = capacity_,
                               .command_capacity = 3 * capacity_,
                               .shaders_populate = true};
        PopulationEntrant entrant{
            Kind::kAnywhere,
            std::max(1u, capacity_ / 2),
            value_of(Crowd::create(device_, {.groups = {group}, .path = population_.path, .culling = Culling{}})),
            {},
            0,
            {}};
        for (uint32_t i = 0; i < capacity_; ++i) entrant.instances.push_back({.instance = i});
        std::shuffle(entrant.instances.begin(), entrant.instances.end(), std::mt19937(1));
        value_of(entrant.crowd.update(0));
        std::vector<InstanceCommand> commands;
        for (uint32_t i = 0; i < entrant.count; ++i) add_birth(commands, entrant, i);
        write(entrant.crowd, commands);
        value_of(entrant.crowd.update(0));
        if (value_of(entrant.crowd.read_drawn()).size() != entrant.count)
            entrant.max_error = std::numeric_limits<double>::infinity();
        else
            entrant.max_error = largest_error_of_some(entrant.count, [&](uint32_t n) { return error_of(entrant, n); });
        return entrant;
    }

    // The first `count` of the list are alive: some of them die, and as many others are born.
    void command(PopulationEntrant& entrant, std::mt19937& random) const {
        std::vector<InstanceCommand> commands;
        for (uint32_t i = 0; i < changed_count_; ++i) {
            const uint32_t gone = std::uniform_int_distribution<uint32_t>(0, entrant.count - 1)(random),
                           born = std::uniform_int_distribution<uint32_t>(std::min(entrant.count, capacity_ - 1),
                                                                          capacity_ - 1)(random);
            commands.push_back(InstanceCommand::despawn(entrant.instances[gone].instance));
            std::swap(entrant.instances[gone], entrant.instances[born]);
            add_birth(commands, entrant, gone);
        }
        write(entrant.crowd, commands);
    }

    void add_birth(std::vector<InstanceCommand>& commands, const PopulationEntrant& entrant, uint32_t i) const {
        const uint32_t instance = entrant.instances[i].instance;
        commands.push_back(InstanceCommand::spawn(instance, population_.placement[i]));
        commands.push_back(InstanceCommand::set_playback(instance, population_.playback[i]));
    }

    // Writes the commands to the first block as a shader would.
    void write(const Crowd& crowd, std::span<const InstanceCommand> commands) const {
        const OutputBlock& block = crowd.outputs()[0];
        const CommandHead head{.count = static_cast<uint32_t>(commands.size())};
        if (!block.host.command.empty()) {
            std::ranges::copy(commands, block.host.command.begin());
            block.host.command_head[0] = head;
            return;
        }
        const Gpu& gpu = *device_.gpu();
        const BufferRange range(block.command.buffer, block.command.offset_bytes, block.command.size_bytes);
        gpu.submit_and_wait([&](VkCommandBuffer recorded) {
            record_update(gpu, recorded, range, 0, std::span(&head, 1));
            record_update(gpu, recorded, range, 1, commands);
        });
    }

    Json new_record(const Crowd& crowd) const {
        Json record = where_and_when(device_.info());
        record.update({{"bench", "population"},
                       {"configuration", population_.configuration},
                       {"path", path_name(crowd)},
                       {"capacity", capacity_},
                       {"joints", population_.character->rig.joint_count()},
                       {"levels", population_.character->rig.level_count}});
        return record;
    }

    Json record_of(const PopulationEntrant& entrant) const {
        Json record = new_record(entrant.crowd);
        record.update({{"instances", kKindNames[static_cast<size_t>(entrant.kind)]},
                       {"characters", entrant.count},
                       {"memory_bytes", entrant.crowd.size_bytes()},
                       {"max_error", entrant.max_error}});
        if (is_wrong(entrant)) record["wrong"] = true;
        entrant.times.add_to(record);
        return record;
    }

    const Device& device_;
    GpuLoad load_;
    const PopulationCase& population_;
    uint32_t capacity_, changed_count_ = 0;
    bool commands_are_wrong_ = false;
    std::vector<PopulationEntrant> entrants_;
    std::vector<Turnover> turnovers_;
};

}  // namespace

std::vector<Json> measure_population(const Device& device, const PopulationCase& population, uint32_t samples,
                                     const Progress& progress) {
    PopulationMeasurement measurement(device, population);
    measurement.check(progress);
    measurement.time(samples, progress);
    measurement.time_turnover(samples, progress);
    return measurement.records();
}

}  // namespace throng::bench
