// What the attach stage computes, in double precision, except for the sockets of the instances that it places: each
// becomes world_from_model times what it was.
#pragma once

#include <throng/transform.h>

namespace throng {

// The placement of an instance that hangs on a socket.
inline AffineT<double> placement_on_socket(const AffineT<double>& world_from_socket,
                                           const AffineT<double>& socket_from_model) {
    return world_from_socket * socket_from_model;
}

}  // namespace throng
