// Results as values, for benchmarks, which end at the first error.
#pragma once

#include "base/failure.h"

#include <throng/result.h>

namespace throng::bench {

// Throws the error as a Failure.
template <class T>
T value_of(Result<T> result) {
    if (!result) throw Failure(result.error());
    if constexpr (!std::is_void_v<T>) return std::move(*result);
}

}  // namespace throng::bench
