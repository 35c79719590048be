// Instances that hang on others: a lantern in a hand, a rider on a beast, the lantern in the rider's hand.
#pragma once

#include <throng/index.h>
#include <throng/population.h>
#include <throng/transform.h>

namespace throng {

// Where an instance of a group with CrowdGroup::is_carried hangs: each update puts it where its carrier's socket is in
// that update.
struct Attachment {
    InstanceHandle carrier{};    // of a group with sockets in world space; it may hang on another itself
    SocketIndex socket = 0;      // which of CrowdGroup::sockets of the carrier's group
    Affine socket_from_model{};  // the model relative to the socket: place, rotation and scale
};

}  // namespace throng
