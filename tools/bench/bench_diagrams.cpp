#include "bench/diagrams/diagram.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/measured.h"

namespace throng::tools {

void add_bench_diagrams(Command bench_command) {
    Command command = bench_command.add_subcommand("diagrams", "a picture of each scan method's data flow, as SVG");
    auto folder = std::make_shared<std::string>();
    command.add_option("--out", *folder, "an existing folder").required().check(existing_folder());
    command.footer("Example:\n  throng bench diagrams --out docs/scan");
    command.callback([folder] {
        for (const bench::Diagram& diagram : bench::scan_diagrams())
            write_text(*folder + "/" + diagram.name + ".svg", diagram.svg);
    });
}

}  // namespace throng::tools
