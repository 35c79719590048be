// Reads a .glb with three.js, an independent reader, and prints as JSON: the names of the clips, the vertex and face
// counts of the skinned meshes, and model_from_joint (column-major) of each joint in skin order, for that clip at that
// time. Usage: node three_reader.js FILE.glb CLIP SECONDS
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
