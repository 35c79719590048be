// Reads a .glb with three.js, a reader that is not ours, and prints as JSON what it finds: the names of the clips, the
// numbers of vertices and faces of the skinned meshes, and of each joint, in the order of the skin, model_from_joint by
// columns, in that clip at that time. Usage: node three_reader.js FILE.glb CLIP SECONDS
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
    const found = { clips: gltf.animations.map((one) => one.name), vertices: 0, faces: 0 };
    gltf.scene.traverse((object) => {
        if (!object.isSkinnedMesh) return;
        const { attributes, index } = object.geometry;
        found.vertices += attributes.position.count;
        found.faces += index.count / 3;
        found.joints = object.skeleton.bones.map((bone) => bone.matrixWorld.elements);
    });
    console.log(JSON.stringify(found));
};
new THREE.GLTFLoader().parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), "", print, (error) => {
    console.error(String(error));
    process.exit(1);
});
