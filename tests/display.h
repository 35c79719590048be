// An X server without a screen, for tests of windows.
#pragma once

#include <string>
#include <sys/types.h>

namespace throng::test {

// Runs Xvfb on a display whose number Xvfb chooses, and ends it in the destructor. Throws std::runtime_error if it
// cannot be started.
class Display {
public:
    // "WIDTHxHEIGHTxDEPTH"
    explicit Display(const char* screen);
    ~Display();
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;

    const std::string& name() const { return name_; }  // the value for DISPLAY

private:
    pid_t server_ = -1;
    std::string name_;
};

}  // namespace throng::test
