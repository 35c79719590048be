// throng bench isa: what GPUs would make of the kernels, seen without one.
#include "bench/isa/machines.h"
#include "bench/isa_bench.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/measured.h"
#include "tools/cli/command.h"

#include <cstdio>
#include <map>

namespace throng::tools {
namespace {

struct IsaOptions {
    std::string family = "navi21";
    bool json = false;
};

// Each loop's own instructions, and how often it runs if that is known.
std::string loops_text(const Json& record) {
    std::string loops;
    for (const Json& loop : record["loops"]) {
        loops += (loops.empty() ? "" : " + ") + std::to_string(loop["all"].get<int>());
        if (!loop.contains("trips")) continue;
        char trips[32];
        std::snprintf(trips, sizeof trips, " x %.6g", loop["trips"].get<double>());
        loops += trips;
    }
    return loops;
}

void print_kernels(std::span<const Json> records) {
    const Json& first = records.front();
    std::printf("%s, %s\n%-40s %-26s %4s %5s %5s %5s %7s %6s %5s %-13s %6s %6s %5s %6s %5s %6s %6s %6s  %s\n",
                text(first, "device").c_str(), text(first, "driver").c_str(), "kernel", "configuration", "size",
                "VGPRs", "SGPRs", "spill", "scratch", "shared", "/SIMD", "limited by", "instr", "vector", "trans",
                "shared", "loads", "stores", "scalar", "waits", "instructions of loops");
    for (const Json& record : records) {
        if (record.contains("machine")) continue;
        std::printf("%-40s %-26.26s", text(record, "kernel").c_str(), text(record, "configuration").c_str());
        print_columns(record, {{" %4.0f", "subgroup_size"}, {" %5.0f", "vgprs"}, {" %5.0f", "sgprs"}});
        std::printf(" %5.0f", real(record, "spilled_vgprs") + real(record, "spilled_sgprs"));
        print_columns(record,
                      {{" %7.0f", "scratch_bytes"}, {" %6.0f", "shared_bytes"}, {" %5.1f", "subgroups_per_simd"}});
        std::printf(" %-13s", text(record, "limited_by").c_str());
        print_columns(record, {{" %6.0f", "instructions/all"},
                               {" %6.0f", "instructions/vector"},
                               {" %5.0f", "instructions/transcendental"},
                               {" %6.0f", "instructions/shared"},
                               {" %5.0f", "instructions/loads"},
                               {" %6.0f", "instructions/stores"},
                               {" %6.0f", "instructions/scalar"}});
        std::printf(" %6.0f  %s\n",
                    real(record, "instructions/memory_waits") + real(record, "instructions/shared_waits"),
                    loops_text(record).c_str());
    }
}

void print_isa_predictions(std::span<const Json> records) {
    std::printf(
        "\nPredicted from the above and data sheets, measured on none of these devices; a dispatch, ms\n"
        "%-12s %-26s %-17s %-20s %4s %8s %6s %5s %8s %8s %8s %9s  %s\n",
        "device", "configuration", "kernel", "scan", "size", "M instr", "MB", "/SIMD", "issue", "waits", "memory",
        "predicted", "limit");
    for (const Json& record : records) {
        if (!record.contains("machine") || text(record, "kernel") != "fused, two clips") continue;
        std::printf("%-12s %-26s %-17s %-20s", text(record, "machine").c_str(), text(record, "configuration").c_str(),
                    text(record, "kernel").c_str(), text(record, "scan").c_str());
        print_columns(record, {{" %4.0f ", "subgroup_size"}});
        if (print_untimed(record, "not predicted")) continue;
        print_columns(record, {{"%8.1f", "instructions_issued", 1e-6},
                               {" %6.0f", "bytes", 1e-6},
                               {" %5.1f", "subgroups_per_simd"},
                               {" %8.3f", "predicted_issue_ms"},
                               {" %8.3f", "predicted_latency_ms"},
                               {" %8.3f", "predicted_memory_ms"},
                               {" %9.3f", "predicted_ms"}});
        std::printf("  %s\n", text(record, "predicted_limit").c_str());
    }
}

// A line for each method, with a column for each number of levels.
void print_scans(std::span<const Json> records) {
    std::map<std::pair<std::string, std::string>, std::vector<const Json*>> found;  // by place and machine
    for (const Json& record : records) {
        const std::string configuration = text(record, "configuration");
        if (!record.contains("machine") || !configuration.starts_with("scan ")) continue;
        const std::string place = configuration.substr(0, configuration.find(','));
        found[{place, text(record, "machine")}].push_back(&record);
    }
    for (const auto& [where, of_machine] : found) {
        std::map<std::string, std::map<double, const Json*>> rows;  // by method and levels
        for (const Json* record : of_machine) rows[text(*record, "scan")][real(*record, "levels")] = record;
        std::printf("\n%s on %s, 10,000 x 300 joints: predicted ms, and instructions a character\n%-20s",
                    where.first.c_str(), where.second.c_str(), "method : levels");
        for (const auto& [levels, record] : rows["stream"]) std::printf(" %16.0f", levels);
        std::printf("\n");
        for (const auto& [method, of_levels] : rows) {
            std::printf("%-20s", method.c_str());
            for (const auto& [levels, of_stream] : rows["stream"]) {
                const auto record = of_levels.find(levels);
                if (record == of_levels.end())
                    std::printf(" %16s", "too large");
                else
                    std::printf(" %8.3f %7.0f", real(*record->second, "predicted_ms"),
                                real(*record->second, "instructions_issued") / real(*record->second, "characters"));
            }
            std::printf("\n");
        }
    }
}

void run_isa(const IsaOptions& options) {
    const std::vector<Json> records = bench::measure_isa(options.family, bench::IsaScope::kAll, print_progress);
    Measured measured(options.json);
    measured.add(records, [&] {
        print_kernels(records);
        print_isa_predictions(records);
        print_scans(records);
    });
}

}  // namespace

void add_bench_isa(Command bench) {
    Command command = bench.add_subcommand(
        "isa", "what AMD's compiler makes of every kernel, without its GPUs, and the times that this predicts");
    IsaOptions& options = command.options_of<IsaOptions>(run_isa);
    std::vector<std::string> families;
    for (const bench::Simd& simd : bench::compiled_families()) families.emplace_back(simd.family);
    command.add_option("--family", options.family, "family of AMD's GPUs")
        .check(is_member(families))
        .capture_default_str();
    add_json_flag(command, options.json);
    command.footer(
        "Needs AMD's Vulkan driver of Mesa, radv (Debian: mesa-vulkan-drivers), and no GPU.\n"
        "Examples:\n  throng bench isa\n  throng bench isa --family gfx1100 --json > gfx1100.jsonl");
}

}  // namespace throng::tools
