// Reads a .glb with three.js, a reader that is not ours, and prints as JSON what it finds: the names of the clips, the numbers of vertices and faces of the skinned mesh, and of each joint, in the order of the skin,
// model_from_joint by columns, in that clip at that time. Usage: node three_reader.js FILE.glb CLIP SECONDS
"use strict";
const fs = require("fs"), vm = require("vm");

const folder = "/usr/share/javascript/three/";  // Debian's libjs-three
for (const file of ["three.js", "examples/js/loaders/GLTFLoader.js"]) vm.runInThisContext(fs.readFileSync(folder + file, "utf8"), { filename: file });

const [path, clip, seconds] = process.argv.slice(2);
const bytes = fs.readFileSync(path);
const print = (gltf) => {
    const mixer = new THREE.AnimationMixer(gltf.scene);
    mixer.clipAction(gltf.animations.find((one) => one.name === clip)).play();
    mixer.setTime(Number(seconds));
    gltf.scene.updateMatrixWorld(true);
    gltf.scene.traverse((object) => {
        if (!object.isSkinnedMesh) return;
        const { attributes, index } = object.geometry;
        console.log(JSON.stringify({ clips: gltf.animations.map((one) => one.name), vertices: attributes.position.count, faces: index.count / 3, joints: object.skeleton.bones.map((bone) => bone.matrixWorld.elements) }));
    });
};
new THREE.GLTFLoader().parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), "", print, (error) => {
    console.error(String(error));
    process.exit(1);
});
