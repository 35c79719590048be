// The buffers of a scan that is not fused.
#include "gpu/buffers_io.h"

WORKGROUP_OF_CONSTANT;
READONLY_BUFFER(kLocalBuffer, StoredTransform, local);
READONLY_BUFFER(kScanLinksBuffer, uint, links);
QUALIFIED_BUFFER(SCAN_EXCHANGE, kModelBuffer, StoredAffine, model);
QUALIFIED_BUFFER(SCAN_EXCHANGE, kScratchBuffer, StoredAffine, scratch);
PUSH(ScanPush);

uint link(uint index) { return links[index]; }

uint at(uint instance, uint joint) {
#ifdef SCAN_TRANSPOSED
    return joint * push.instance_count + instance;
#else
    return instance * push.joint_count + joint;
#endif
}
