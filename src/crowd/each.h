// What a call sets: one value for each of its instances, or one for all of them.
#pragma once

#include "base/failure.h"

#include <throng/population.h>

#include <span>

namespace throng {

template <class T>
class Each {
public:
    explicit Each(const T& all) : values_(&all, 1), step_(0) {}
    // Throws kInvalidArgument at `place` if their numbers differ.
    Each(const Instances& instances, std::span<const T> values, const char* place) : values_(values), step_(1) {
        if (values.size() != instances.size())
            throw Failure(ErrorCode::kInvalidArgument, place, values.size(), " values for ", instances.size(),
                          " instances");
    }

    // The value of the i-th instance of the call.
    const T& operator[](size_t i) const { return values_[i * step_]; }

private:
    std::span<const T> values_;
    size_t step_;
};

}  // namespace throng
