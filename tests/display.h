// An X server without a screen, for tests of windows.
#pragma once

#include <string>
#include <sys/types.h>

namespace throng::test {

// Xvfb on a display of its own, which it chooses itself; ends with it. Throws std::runtime_error where it cannot be
// started.
class Display {
public:
    // "WIDTHxHEIGHTxDEPTH"
    explicit Display(const char* screen);
    ~Display();
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;

    const std::string& name() const { return name_; }  // for DISPLAY

private:
    pid_t server_ = -1;
    std::string name_;
};

}  // namespace throng::test
