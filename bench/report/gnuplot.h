// gnuplot as a child process.
#pragma once

#include <string>

namespace throng::bench {

// Runs a script and returns what gnuplot writes to standard output. Throws kUnsupported if gnuplot is not installed,
// and kInvalidArgument with its first complaint if the script fails.
std::string run_gnuplot(const std::string& script);

// `text` as a string of a script: on one line, and nothing in it acts as a command, a substitution or the string's end.
std::string gnuplot_text(const std::string& text);

// `value` as a number of a script, whatever the locale.
std::string gnuplot_number(double value);

}  // namespace throng::bench
