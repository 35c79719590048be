// A track of the file, evaluated exactly: what the compiled clip must reproduce.
#pragma once

#include "compile/rig/rig.h"
#include "sample/track_value.h"

namespace throng {

// Evaluates one AssetTrack at any time as glTF 2.0, appendix C, says, mapped into its joint's space by `prefix`. Keeps
// references.
class SourceTrack {
public:
    SourceTrack(const AssetTrack& track, const Similarity& prefix) : track_(track), prefix_(prefix) {}

    const AssetTrack& track() const { return track_; }
    bool is_constant() const;
    TrackValue evaluate(double time_s) const;

private:
    TrackValue value(size_t index) const;  // index of a value, not of a key
    TrackValue mapped(const TrackValue& v) const;

    const AssetTrack& track_;
    const Similarity& prefix_;
};

// How far apart two values of a track are, in the unit of its target: radians, metres or a factor.
double distance(TrackTarget target, const TrackValue& a, const TrackValue& b);

}  // namespace throng
