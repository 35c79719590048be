// Prints what the Khronos glTF validator reports about a .glb, as JSON: the number of issues of each severity, and
// their messages. Usage: node khronos_validator.js FILE.glb
"use strict";
const validator = require("gltf-validator");  // from npm

validator.validateBytes(new Uint8Array(require("fs").readFileSync(process.argv[2]))).then(
    ({ issues }) => console.log(JSON.stringify({ errors: issues.numErrors, warnings: issues.numWarnings, infos: issues.numInfos, hints: issues.numHints, messages: issues.messages.map((one) => `${one.pointer}: ${one.message}`) })),
    (error) => {
        console.error(String(error));
        process.exit(1);
    });
