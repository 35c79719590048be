// Makes the files of this folder with meshoptimizer's own encoder and decoder, which know version 1 of the codec:
//   npm install meshoptimizer@1.3.0 && node make.mjs
// NAME.bin is compressed; what it holds is computed by import_meshopt_v1_test.cpp, which lists the files too. For the
// colours, whose filter loses precision, NAME_decoded.bin is what the decoder makes of them.
import {writeFileSync} from 'node:fs';
import {MeshoptDecoder, MeshoptEncoder} from 'meshoptimizer';

await MeshoptEncoder.ready;
await MeshoptDecoder.ready;

const write = (name, bytes) => writeFileSync(new URL(name, import.meta.url), bytes);

// The 32 bits of channel `c` in element `i`; the same function is in the test. Each kind of content is what some part
// of the codec is for.
function word(i, c) {
    const noise = Math.imul(Math.imul(i * 64 + c + 1, 0x9E3779B1) ^ 0x7F4A7C15, 0x85EBCA6B) >>> 8;
    switch (c % 8) {
        case 0: return i * i * 3 + (((i * 40503) & 0xFFFF) << 16);  // 16-bit: a parabola, a line
        case 1: return (i >> 5) | (i & 1) << 8 | (noise & 3) << 16 | (noise & 12) << 22;  // bytes of few bits
        case 2: return 0x3F800000 + ((noise & 7) << 9);  // floats: some bits in the middle
        case 3: return 0x01020304;  // always the same
        case 4: return noise << 8;  // noise, and a byte of zeros
        case 5: return (noise & 15) | (i % 50 == 7 ? 0xAB0000 : 0) | (i % 16 > 12 ? noise & 0xFF00 : 0);  // outliers
        case 6: return (i % 9) | (noise & 31) << 8 | ((i * 5) & 255) << 16;  // bytes: slopes and jumps
        default: return 0x40000000 ^ (i << 13) ^ (noise & 1);  // floats: a slope
    }
}

function elements(count, stride) {
    const out = new DataView(new ArrayBuffer(count * stride));
    for (let i = 0; i < count; ++i)
        for (let c = 0; c < stride / 4; ++c) out.setUint32(i * stride + c * 4, word(i, c) >>> 0, true);
    return new Uint8Array(out.buffer);
}

// The encoder's levels: from 1 on it knows rows of zeros and uncompressed ones, from 2 on 16-bit differences, at 3 XOR.
for (const [count, stride, level] of [[1, 4, 2], [257, 8, 1], [33, 12, 2], [300, 16, 0], [300, 16, 3], [531, 32, 3],
                                      [70, 256, 3]])
    write(`attributes_${count}x${stride}_level${level}.bin`,
          MeshoptEncoder.encodeVertexBufferLevel(elements(count, stride), count, stride, level, 1));

// The positions of tiny_character() in tests/glb_builder.h.
const triangle = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]);
write('triangle.bin', MeshoptEncoder.encodeVertexBufferLevel(new Uint8Array(triangle.buffer), 3, 12, 2, 1));

const count = 100, colors = new Float32Array(4 * count);
for (let i = 0; i < count; ++i)
    colors.set([i, i * 7, 255 - i, i * 3].map((component) => component % 256 / 255), i * 4);
for (const [stride, bits] of [[4, 8], [4, 5], [4, 2], [8, 16], [8, 12]]) {
    const filtered = MeshoptEncoder.encodeFilterColor(colors, count, stride, bits);
    const compressed = MeshoptEncoder.encodeVertexBufferLevel(filtered, count, stride, 2, 1);
    const decoded = new Uint8Array(count * stride);
    MeshoptDecoder.decodeGltfBuffer(decoded, count, stride, compressed, 'ATTRIBUTES', 'COLOR');
    write(`colors_${stride}_${bits}bit.bin`, compressed);
    write(`colors_${stride}_${bits}bit_decoded.bin`, decoded);
}
