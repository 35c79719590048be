// Errors as values. No exception crosses throng's API.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <variant>

namespace throng {

enum class ErrorCode {
    kInvalidArgument,  // the caller's value is out of its documented range
    kFile,             // a file cannot be opened, read or written
    kInvalidFile,      // a file's content breaks its format
    kUnsupported,      // valid, but not something throng or the device can do
    kLimit,            // a stated limit of throng or of the device is exceeded
    kNoDevice,         // no Vulkan device fits the request
    kOutOfMemory,
    kVulkan,      // a Vulkan call failed; the message names the call and its result
    kCancelled,   // LoadHooks::is_cancelled returned true
    kDeviceLost,  // all later calls that need the device fail: destroy renderers, crowds and the Device, and start anew
};

// What went wrong and where: `place` is a path into the input ("fox.glb: animations[2].channels[5]"), or empty.
struct Error {
    ErrorCode code = ErrorCode::kInvalidArgument;
    std::string place{};
    std::string message{};

    // "place: message", one line.
    std::string text() const { return place.empty() ? message : place + ": " + message; }
};

[[noreturn]] inline void exit_with(const Error& error) {
    std::fprintf(stderr, "%s\n", error.text().c_str());
    std::exit(1);
}

// For errors that only a mistake in the program can cause: prints the error and aborts.
[[noreturn]] inline void abort_with(const char* what, const Error& error) {
    std::fprintf(stderr, "%s: %s\n", what, error.text().c_str());
    std::abort();
}

// A T, or the Error that prevented it. Accessing the one that is not there is a mistake in the program: it prints a
// line, with the Error where there is one, and aborts.
template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

    bool ok() const { return state_.index() == 0; }
    explicit operator bool() const { return ok(); }

    T& operator*() & { return value(); }
    const T& operator*() const& { return value(); }
    T&& operator*() && { return std::move(value()); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }

    T& value() & {
        require_value();
        return std::get<0>(state_);
    }
    const T& value() const& {
        require_value();
        return std::get<0>(state_);
    }
    T&& value() && {
        require_value();
        return std::get<0>(std::move(state_));
    }
    const Error& error() const {
        if (ok()) abort_with("throng::Result::error()", {.message = "there is none, but a value"});
        return std::get<1>(state_);
    }

    T value_or(T other) && { return ok() ? std::move(*this).value() : std::move(other); }
    T value_or(T other) const& { return ok() ? value() : std::move(other); }
    // For programs that cannot go on without the value: if there is an error, prints it as a line on stderr and ends
    // the program with exit code 1.
    T expect() && {
        if (!ok()) exit_with(error());
        return std::move(*this).value();
    }
    const T& expect() const& {
        if (!ok()) exit_with(error());
        return value();
    }

private:
    void require_value() const {
        if (!ok()) abort_with("throng::Result without a value", std::get<1>(state_));
    }

    std::variant<T, Error> state_;
};

// Success, or the Error that prevented it.
template <>
class [[nodiscard]] Result<void> {
public:
    Result() = default;
    Result(Error error) : error_(std::move(error)), failed_(true) {}

    bool ok() const { return !failed_; }
    explicit operator bool() const { return ok(); }
    const Error& error() const {
        if (!failed_) abort_with("throng::Result::error()", {.message = "there is none: the call succeeded"});
        return error_;
    }
    // As Result<T>::expect().
    void expect() const {
        if (failed_) exit_with(error_);
    }

private:
    Error error_;
    bool failed_ = false;
};

}  // namespace throng
