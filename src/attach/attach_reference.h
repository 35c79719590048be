// Defines the placements that the attach stage computes, in double precision. Besides, the stage multiplies each socket
// of the instances that it places by world_from_model.
#pragma once

#include <throng/transform.h>

namespace throng {

// world_from_model of an instance that is attached to a socket.
inline AffineT<double> placement_on_socket(const AffineT<double>& world_from_socket,
                                           const AffineT<double>& socket_from_model) {
    return world_from_socket * socket_from_model;
}

}  // namespace throng
