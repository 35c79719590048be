// gnuplot as a child process.
#pragma once

#include <string>

namespace throng::bench {

// Runs a script and returns what gnuplot writes to standard output. Throws kUnsupported where gnuplot is not installed,
// and kInvalidArgument with its first complaint where the script fails.
std::string run_gnuplot(const std::string& script);

// `text` as a string of a script: of one line, and nothing in it is a command, a substitution or the string's end.
std::string gnuplot_text(const std::string& text);

// `value` as a number of a script, whatever the locale.
std::string gnuplot_number(double value);

}  // namespace throng::bench
