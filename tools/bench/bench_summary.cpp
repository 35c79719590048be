// throng bench summary: the times of earlier runs in one Markdown table for each benchmark, beside what was predicted.
#include "bench/summary.h"
#include "tools/cli/inputs.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/measured.h"

namespace throng::tools {
namespace {

struct SummaryOptions {
    std::vector<std::string> files;
    std::string predictions, out;
};

void run_summary(const SummaryOptions& options) {
    std::vector<std::string> inputs = options.files;
    if (!options.predictions.empty()) inputs.push_back(options.predictions);
    protect_inputs(inputs, {options.out});
    const std::vector<Json> records = bench::read_records(options.files);
    std::vector<Json> predictions;
    if (!options.predictions.empty()) predictions = bench::read_records(options.predictions);
    write_text(options.out, bench::summary_text(records, predictions));
}

}  // namespace

void add_bench_summary(Command bench_command) {
    Command command = bench_command.add_subcommand(
        "summary", "records of 'throng bench' as Markdown, a line for each time, beside what was predicted");
    auto options = std::make_shared<SummaryOptions>();
    command.add_option("records", options->files, "files of records, one per line").required();
    command.add_option("--predictions", options->predictions,
                       "records of 'throng bench isa' and 'throng bench million'");
    add_out_option(command, options->out, "the .md file to write");
    command.footer("Example:\n  throng bench summary records.jsonl --predictions isa.jsonl --out SUMMARY.md");
    command.callback([options] { run_summary(*options); });
}

}  // namespace throng::tools
