// throng bench report: the records of earlier runs as a page, or the paper's figure alone.
#include "bench/scan_report.h"
#include "tools/cli/inputs.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/measured.h"

namespace throng::tools {
namespace {

struct ReportOptions {
    std::vector<std::string> files;
    std::string out, plot;
    bool tables = false;
};

void run_report(const ReportOptions& options) {
    protect_inputs(options.files, {options.out, options.plot});
    const std::vector<Json> records = bench::read_records(options.files);
    if (!options.plot.empty()) write_text(options.plot, bench::scan_levels_plot(records));
    write_text(options.out, bench::scan_report(records, !options.tables));
}

}  // namespace

void add_bench_report(Command bench_command) {
    Command command = bench_command.add_subcommand(
        "report", "records of 'throng bench' as an HTML page: those of 'scan' and 'frame' with figures, by gnuplot");
    auto options = std::make_shared<ReportOptions>();
    command.add_option("records", options->files, "files of records, one per line; the last record of a case counts")
        .required();
    add_out_option(command, options->out, "the .html file to write; it needs no other file");
    command.add_option("--plot", options->plot, "an .svg file to write with the figure of time over levels")
        .check(writable_file());
    command.add_flag("--tables", options->tables, "leave out the figures, so that gnuplot is not needed");
    command.footer("Example:\n  throng bench report scan.jsonl baselines.jsonl --out report.html --plot levels.svg");
    command.callback([options] { run_report(*options); });
}

}  // namespace throng::tools
