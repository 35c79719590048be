#include "bench/report/gnuplot.h"

#include "base/failure.h"
#include "tools/cli/child_program.h"

#include <array>
#include <charconv>

namespace throng::bench {
namespace {

// gnuplot repeats the line of the script before it says what is wrong with it.
std::string first_complaint(const std::string& errors) {
    const size_t start = errors.find("line ");
    const std::string complaint = errors.substr(start == std::string::npos ? 0 : start);
    return complaint.substr(0, complaint.find('\n'));
}

}  // namespace

std::string run_gnuplot(const std::string& script) {
    const ChildOutput child = run_child_program({"gnuplot", "--default-settings"}, script);
    if (child.start == ChildOutput::Start::kMissing)
        throw Failure(ErrorCode::kUnsupported, "gnuplot",
                      "not installed, and the plots need it (Debian: apt-get install gnuplot-nox)");
    if (child.start == ChildOutput::Start::kRefused)
        throw Failure(ErrorCode::kUnsupported, "gnuplot", "cannot be started: " + child.errors);
    if (child.status != 0) throw Failure(ErrorCode::kInvalidArgument, "gnuplot", first_complaint(child.errors));
    return child.output;
}

std::string gnuplot_text(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (static_cast<unsigned char>(c) < ' ')
            quoted += ' ';
        else if (c == '`' || c == '"')
            quoted += '\'';
        else if (c == '\\')
            quoted += "\\\\";
        else
            quoted += c;
    }
    return quoted + '"';
}

std::string gnuplot_number(double value) {
    std::array<char, 32> digits;
    return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

}  // namespace throng::bench
