// What the attach stage computes, in double precision, beside the sockets of what it has placed: world_from_model of
// these, times what they were.
#pragma once

#include <throng/transform.h>

namespace throng {

// Where an instance is that hangs on a socket: its placement.
inline AffineT<double> placement_on_socket(const AffineT<double>& world_from_socket,
                                           const AffineT<double>& socket_from_model) {
    return world_from_socket * socket_from_model;
}

}  // namespace throng
