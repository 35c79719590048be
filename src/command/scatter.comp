// scatter: copies the CPU's changes of scattered instances into the buffers. One invocation per word. Cost: the word
//   and its item's index read, the word written.
#include "command/command_io.h"
#include "gpu/buffers_io.h"

WORKGROUP(kCommandWorkgroupSize);
READONLY_BUFFER(kChangesBuffer, uint, changes);
BUFFER(kChangedBuffer, uint, changed);
PUSH(ScatterPush);

void main() {
    const uint item = gl_GlobalInvocationID.x / push.item_words, word = gl_GlobalInvocationID.x % push.item_words;
    if (item >= push.count) return;
    const uint at = push.first_word + item * (1 + push.item_words);
    changed[changes[at] * push.item_words + word] = changes[at + 1 + word];
}
