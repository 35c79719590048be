// Values of enumerations that an application has given, which may be any number that was cast to one.
#pragma once

#include "base/failure.h"

#include <string>
#include <type_traits>

namespace throng {

// Whether `value` is one of an enumeration's, which run from 0 to `last`.
template <class Enumeration>
constexpr bool is_known(Enumeration value, Enumeration last) {
    using Number = std::underlying_type_t<Enumeration>;
    return static_cast<Number>(value) >= Number{0} && value <= last;
}

// Throws kInvalidArgument with `place`.
template <class Enumeration>
void check_known(Enumeration value, Enumeration last, const std::string& place) {
    using Number = std::underlying_type_t<Enumeration>;
    if (!is_known(value, last))
        throw Failure(ErrorCode::kInvalidArgument, place, static_cast<Number>(value),
                      " is none of its values, which are 0 to ", static_cast<Number>(last));
}

}  // namespace throng
