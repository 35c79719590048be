// A self-contained page: style and script are in it, nothing is fetched.
#pragma once

#include <string>
#include <string_view>

namespace throng::bench {

// For text, and for attributes in double quotes.
std::string escape(std::string_view text);

// Three significant digits and separated thousands: 0.0123, 1.23, 12.3, 12,345. A dash for NaN.
std::string digits(double value);
std::string whole(double value);

// A section that opens when its summary is clicked, or is open from the start; empty without content.
std::string details(const std::string& summary, const std::string& content, bool open);

std::string html_page(const std::string& title, const std::string& body);

}  // namespace throng::bench
