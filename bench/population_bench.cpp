#include "bench/population_bench.h"

#include "bench/value_of.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <random>

namespace throng::bench {
namespace {

constexpr std::array kParts{0.1, 0.5, 1.0};

enum class Kind { kForGood, kTogether, kLast, kAnywhere };
constexpr std::array kKindNames{"for good", "together", "last", "anywhere"};

struct PopulationCandidate {
    Kind kind = Kind::kForGood;
    uint32_t count = 0;
    Crowd crowd;
    std::vector<InstanceHandle> instances{};
    std::vector<uint32_t> plays{};  // for each of `instances`: the number of its playback in the case
    size_t found_count = 0;         // instances that the check has found
    double max_error = 0;
    UpdateTimes times{};

    bool is_wrong() const { return !(max_error <= kSkinErrorBound); }
};

// Frames in which many instances change.
struct Turnover {
    const char* name = "";
    PopulationCandidate candidate;
    std::function<void(PopulationCandidate&)> change;
    std::vector<double> call_ms{}, update_ms{};
};

class PopulationMeasurement {
public:
    PopulationMeasurement(const Device& device, const PopulationCase& population, const SkinReference& reference)
        : device_(device),
          load_(device.gpu()),
          population_(population),
          reference_(reference),
          capacity_(static_cast<uint32_t>(population.playback.size())),
          changed_count_(std::max(1u, capacity_ / 4)) {}

    void check(const Progress& progress) {
        for (const double part : kParts)
            for (const Kind kind : {Kind::kForGood, Kind::kTogether, Kind::kLast, Kind::kAnywhere}) {
                const auto count = std::max(1u, static_cast<uint32_t>(part * capacity_));
                progress(population_.configuration + ": checking " + std::to_string(count));
                compare(candidates_.emplace_back(make(kind, count)));
            }
    }

    // Crowds that fill half of their capacity; half of their instances change in each frame. Each is checked after one.
    void check_turnover(const Progress& progress) {
        const uint32_t count = std::max(1u, capacity_ / 2);
        turnovers_.push_back(
            {"playbacks", make(Kind::kAnywhere, count), [&](auto& changed) { change_playback(changed); }});
        turnovers_.push_back(
            {"births and deaths", make(Kind::kAnywhere, count), [&](auto& reborn) { replace(reborn); }});
        turnovers_.push_back({"by shaders", make_commanded(count), [&](auto& commanded) { command(commanded); }});
        for (Turnover& turnover : turnovers_) {
            progress(population_.configuration + ": checking " + turnover.name);
            value_of(turnover.candidate.crowd.update(0));
            turnover.change(turnover.candidate);
            compare(turnover.candidate);
        }
    }

    void time(uint32_t samples, const Progress& progress) {
        std::vector<TimedRun> timed_runs;
        for (PopulationCandidate& candidate : candidates_)
            if (!candidate.is_wrong())
                timed_runs.push_back({population_.configuration + ": " + std::to_string(candidate.count),
                                      [&] { candidate.times.take(load_, candidate.crowd); }});
        run_rounds(timed_runs, samples, progress);
    }

    void time_turnover(uint32_t samples, const Progress& progress) {
        std::vector<TimedRun> timed_runs;
        for (Turnover& turnover : turnovers_)
            if (!turnover.candidate.is_wrong())
                timed_runs.push_back(
                    {population_.configuration + ": " + turnover.name, [&] { take_sample(turnover); }});
        run_rounds(timed_runs, samples, progress);
    }

    std::vector<Json> records() const {
        std::vector<Json> all;
        for (const PopulationCandidate& candidate : candidates_) all.push_back(record_of(candidate));
        for (const Turnover& turnover : turnovers_) all.push_back(record_of(turnover));
        return all;
    }

private:
    // The n-th instance of each candidate plays and stands as the n-th of the case.
    PopulationCandidate make(Kind kind, uint32_t count) const {
        CrowdGroup group{.character = population_.character};
        if (kind == Kind::kForGood)
            group.instance_count = count;
        else
            group.capacity = capacity_;
        PopulationCandidate candidate = candidate_of(kind, count, group);
        Crowd& crowd = candidate.crowd;
        if (kind == Kind::kForGood) {
            for (uint32_t i = 0; i < count; ++i) candidate.instances.push_back({.instance = i});
        } else {
            const uint32_t born = kind == Kind::kTogether ? count : capacity_;
            candidate.instances = value_of(crowd.spawn(0, population_.placement.first(born)));
            if (kind == Kind::kLast)
                std::ranges::reverse(candidate.instances);
            else
                std::ranges::shuffle(candidate.instances, std::mt19937(1));
            value_of(crowd.despawn(std::span(candidate.instances).subspan(count)));
            candidate.instances.resize(count);
        }
        value_of(crowd.set_placement(candidate.instances, population_.placement.first(count)));
        value_of(crowd.set_playback(candidate.instances, population_.playback.first(count)));
        return candidate;
    }

    PopulationCandidate candidate_of(Kind kind, uint32_t count, const CrowdGroup& group) const {
        PopulationCandidate candidate{
            kind, count,
            value_of(Crowd::create(device_, {.groups = {group}, .path = population_.path, .culling = Culling{}}))};
        candidate.plays.resize(count);
        std::iota(candidate.plays.begin(), candidate.plays.end(), 0u);
        return candidate;
    }

    // Checks after an update of zero time. A wrong number of instances counts as an infinite error.
    void compare(PopulationCandidate& candidate) const {
        value_of(candidate.crowd.update(0));
        candidate.found_count = value_of(candidate.crowd.read_drawn()).size();
        if (candidate.found_count != candidate.count)
            candidate.max_error = std::numeric_limits<double>::infinity();
        else
            candidate.max_error = largest_error_of_some(candidate.count,
                                                        [&](uint32_t i) { return error_of(candidate, i); });
    }

    double error_of(PopulationCandidate& candidate, uint32_t i) const {
        return skin_error(value_of(candidate.crowd.read_skin_matrices(candidate.instances[i])),
                          reference_(*population_.character, population_.playback[candidate.plays[i]]),
                          population_.character->size);
    }

    void take_sample(Turnover& turnover) const {
        load_.run();
        const Stopwatch calls;
        turnover.change(turnover.candidate);
        turnover.call_ms.push_back(calls.elapsed_s() * 1e3);
        const Stopwatch update;
        value_of(turnover.candidate.crowd.update(kFrame_s));
        turnover.update_ms.push_back(update.elapsed_s() * 1e3);
    }

    // Moves the instances to be changed, chosen at random, to the end of the list.
    void choose(PopulationCandidate& candidate) {
        for (uint32_t i = 0; i < changed_count_; ++i) {
            const uint32_t last = candidate.count - 1 - i,
                           chosen = std::uniform_int_distribution<uint32_t>(0, last)(random_);
            std::swap(candidate.instances[last], candidate.instances[chosen]);
            std::swap(candidate.plays[last], candidate.plays[chosen]);
        }
    }

    void change_playback(PopulationCandidate& candidate) {
        choose(candidate);
        set_playback(candidate);
    }

    void replace(PopulationCandidate& candidate) {
        choose(candidate);
        const uint32_t kept = candidate.count - changed_count_;
        value_of(candidate.crowd.despawn(std::span(candidate.instances).subspan(kept)));
        const std::vector<InstanceHandle> born = value_of(
            candidate.crowd.spawn(0, population_.placement.subspan(kept, changed_count_)));
        std::ranges::copy(born, candidate.instances.begin() + kept);
        set_playback(candidate);
    }

    // Sets the playback of the instances at the end of the list.
    void set_playback(PopulationCandidate& candidate) const {
        const uint32_t kept = candidate.count - changed_count_;
        value_of(candidate.crowd.set_playback(std::span(candidate.instances).subspan(kept),
                                              population_.playback.subspan(kept, changed_count_)));
        std::iota(candidate.plays.begin() + kept, candidate.plays.end(), kept);
    }

    // Like make(), but spawns the instances by commands, as shaders do, at a random half of the instance numbers.
    PopulationCandidate make_commanded(uint32_t count) const {
        PopulationCandidate candidate = candidate_of(Kind::kAnywhere, count,
                                                     {.character = population_.character,
                                                      .capacity = capacity_,
                                                      .shader_commands = ShaderCommands{3 * capacity_, true}});
        for (uint32_t i = 0; i < capacity_; ++i) candidate.instances.push_back({.instance = i});
        std::shuffle(candidate.instances.begin(), candidate.instances.end(), std::mt19937(1));
        value_of(candidate.crowd.update(0));
        std::vector<InstanceCommand> commands;
        for (uint32_t i = 0; i < count; ++i) add_birth(commands, candidate, i);
        write(candidate.crowd, commands);
        return candidate;
    }

    // The first `count` instances of the list are alive. Some of them die, and as many others are born with the same
    // playbacks.
    void command(PopulationCandidate& candidate) {
        std::vector<InstanceCommand> commands;
        for (uint32_t i = 0; i < changed_count_; ++i) {
            const uint32_t gone = std::uniform_int_distribution<uint32_t>(0, candidate.count - 1)(random_),
                           born = std::uniform_int_distribution<uint32_t>(std::min(candidate.count, capacity_ - 1),
                                                                          capacity_ - 1)(random_);
            commands.push_back(InstanceCommand::despawn(candidate.instances[gone].instance));
            std::swap(candidate.instances[gone], candidate.instances[born]);
            add_birth(commands, candidate, gone);
        }
        write(candidate.crowd, commands);
    }

    void add_birth(std::vector<InstanceCommand>& commands, const PopulationCandidate& candidate, uint32_t i) const {
        const uint32_t instance = candidate.instances[i].instance;
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

    Json record_of(const PopulationCandidate& candidate, const char* field, const char* name) const {
        Json record = new_record(device_, "population", population_.configuration, *population_.character);
        record.update({{"path", path_name(candidate.crowd)},
                       {"capacity", capacity_},
                       {field, name},
                       {"characters", candidate.count},
                       {"max_error", candidate.max_error}});
        if (candidate.is_wrong()) record["wrong"] = true;
        if (candidate.found_count != candidate.count) record["found"] = candidate.found_count;
        return record;
    }

    Json record_of(const PopulationCandidate& candidate) const {
        Json record = record_of(candidate, "instances", kKindNames[static_cast<size_t>(candidate.kind)]);
        record["memory_bytes"] = candidate.crowd.size_bytes();
        candidate.times.add_to(record);
        return record;
    }

    Json record_of(const Turnover& turnover) const {
        Json record = record_of(turnover.candidate, "frames_with", turnover.name);
        record["changed"] = changed_count_;
        if (turnover.candidate.is_wrong()) return record;
        record.update({{"samples", turnover.call_ms.size()},
                       {"call_ms", spread_json(spread_of(turnover.call_ms))},
                       {"update_ms", spread_json(spread_of(turnover.update_ms))}});
        return record;
    }

    const Device& device_;
    GpuLoad load_;
    const PopulationCase& population_;
    const SkinReference& reference_;
    uint32_t capacity_, changed_count_;
    std::mt19937 random_{2};
    std::vector<PopulationCandidate> candidates_;
    std::vector<Turnover> turnovers_;
};

}  // namespace

std::vector<Json> measure_population(const Device& device, const PopulationCase& population, uint32_t samples,
                                     const Progress& progress, const SkinReference& reference) {
    PopulationMeasurement measurement(device, population, reference);
    measurement.check(progress);
    measurement.check_turnover(progress);
    measurement.time(samples, progress);
    measurement.time_turnover(samples, progress);
    return measurement.records();
}

}  // namespace throng::bench
