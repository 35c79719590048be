// Inside throng errors are thrown as Failure; at the API they become a Result. Only as_result() converts between the
// two.
#pragma once

#include "base/default_floats.h"
#include "base/error_place.h"
#include "base/text.h"

#include <throng/result.h>

#include <exception>
#include <new>
#include <type_traits>

namespace throng {

struct Failure : std::exception {
    // Names that an application has given, or a file, may be part of the texts: they are made safe for one line.
    explicit Failure(Error e)
        : error{e.code, printable(e.place, std::string::npos), printable(e.message, std::string::npos)},
          text(error.text()) {}
    // The message is the concatenation of the parts.
    template <class... Parts>
    Failure(ErrorCode code, std::string place, const Parts&... message)
        : Failure(Error{code, std::move(place), joined(message...)}) {}
    const char* what() const noexcept override { return text.c_str(); }

    Error error;
    std::string text;
};

// Throws kInvalidArgument: the argument that `place` names is not acceptable.
template <class... Parts>
[[noreturn]] void refuse(const ErrorPlace& place, const Parts&... message) {
    throw Failure(ErrorCode::kInvalidArgument, place, message...);
}

// Calls a callback of the application. Exceptions that it throws become Failures, whose messages call it `name`.
template <class Call>
auto call_application(const std::string& place, const char* name, const Call& call) {
    try {
        return call();
    } catch (const std::bad_alloc&) {
        throw Failure(ErrorCode::kOutOfMemory, place, name, ": out of memory");
    } catch (const std::exception& thrown) {
        throw Failure(ErrorCode::kInvalidArgument, place, name, " threw: ", printable(thrown.what(), 200));
    } catch (...) {
        throw Failure(ErrorCode::kInvalidArgument, place, name, " threw");
    }
}

// Runs `body`, with DefaultFloats, and returns its value, or the Error that it threw. `place` is given to errors that
// name none.
template <class Body>
auto as_result(Body&& body, std::string place = {}) -> Result<std::invoke_result_t<Body>> {
    using T = std::invoke_result_t<Body>;
    const DefaultFloats floats;
    try {
        if constexpr (std::is_void_v<T>) {
            body();
            return {};
        } else {
            return body();
        }
    } catch (const Failure& failure) {
        Error error = failure.error;
        if (error.place.empty()) error.place = printable(place, std::string::npos);
        return error;
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::kOutOfMemory, std::move(place), "out of memory"};
    } catch (const std::exception& other) {
        return Failure(ErrorCode::kInvalidArgument, std::move(place), other.what()).error;
    } catch (...) {  // of an application's JobSystem
        return Error{ErrorCode::kInvalidArgument, std::move(place),
                     "an exception was thrown that is not a std::exception"};
    }
}

}  // namespace throng
