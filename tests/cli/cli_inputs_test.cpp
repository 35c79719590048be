// No command overwrites its own input, whatever path names it.
#include "tests/glb_builder.h"
#include "tests/tool_runner.h"

namespace throng {
namespace {

using namespace test;
namespace fs = std::filesystem;

class CliInputs : public ToolTest {
protected:
    static void SetUpTestSuite() {
        ToolTest::SetUpTestSuite();
        GlbBuilder character = tiny_character();
        write("fox.glb", character.glb());
        write("side.bin", std::string(reinterpret_cast<const char*>(character.bin.data()), character.bin.size()));
        write("skin of fox.png", "no picture");
        character.json["buffers"] = {{{"uri", "side.bin"}, {"byteLength", character.bin.size()}}};
        character.json["images"] = {{{"uri", "nobody.png"}}, {{"uri", "skin%20of%20fox.png"}}};
        write("fox.gltf", character.json.dump());
        write("c.json", R"({"layers": [{"name": "body", "states": {"turn": {"clip": "turn"}}}]})");
        for (const char* name : {"c.dot", "frame_settings.json"}) write(name, read_file("c.json"));
        write("records.jsonl", R"({"bench": "scan", "experiment": "levels", "method": "serial", "levels": 15, )"
                               R"("median_ms": 3, "copy_ms": 2, "times_copy": 1.5})"
                               "\n");
        fs::create_directory("below");
        fs::create_hard_link("fox.glb", "hard.glb");
        fs::create_symlink("fox.glb", "soft.glb");
        fs::create_directory("film.mp4.frames");
        fs::create_hard_link("fox.glb", "film.mp4.frames/000002.png");
        fs::create_hard_link("fox.glb", "frame_03.png");
    }

    static std::map<fs::path, std::string> contents() {
        std::map<fs::path, std::string> of_files;
        for (const auto& entry : fs::recursive_directory_iterator(folder_->path()))
            if (entry.is_regular_file()) of_files[entry.path()] = read_file(entry.path());
        return of_files;
    }
};

TEST_F(CliInputs, AreNotWrittenOver) {
    const auto over = [](const std::string& out, const std::string& input) {
        return "throng: " + out + ": would overwrite " + input + ", which this command reads";
    };
    const std::string image = "skin of fox.png";
    std::vector<Refused> cases;
    for (const char* name : {"fox.glb", "hard.glb", "soft.glb", "below/../fox.glb", "below//..//fox.glb"}) {
        const std::string out = name;
        cases.push_back({"render fox.glb --out " + out, over(out, "fox.glb")});
        cases.push_back({"compile fox.glb --out " + out, over(out, "fox.glb")});
        cases.push_back({"view fox.glb --after 1 --screenshot " + out, over(out, "fox.glb")});
    }
    for (const std::string given : {"c.json", "fox.glb=c.json"})
        cases.push_back({"render fox.glb --controller " + given + " --out c.json", over("c.json", "c.json")});
    cases.insert(
        cases.end(),
        {{"render soft.glb --out fox.glb", over("fox.glb", "soft.glb")},
         {"render fox.glb fox.gltf --out side.bin", over("side.bin", "side.bin of fox.gltf")},
         {{"render", "fox.gltf", "--out", image}, over(image, "skin%20of%20fox.png of fox.gltf")},
         {"compile fox.gltf --out side.bin", over("side.bin", "side.bin of fox.gltf")},
         {"render fox.glb --frames 0:4 --out film.mp4", over("film.mp4.frames/000002.png", "fox.glb")},
         {"render fox.glb --frames 0:4 --shard 0/2 --out frame_%02d.png", over("frame_03.png", "fox.glb")},
         {"render fox.glb --controller frame_settings.json --frames 0:2 --out frame_%02d.png",
          over("frame_settings.json", "frame_settings.json")},
         {"view fox.glb --controller c.json --screenshot c.json", over("c.json", "c.json")},
         {"view fox.glb --after 1 --dump fox.glb", over("fox.glb", "fox.glb")},
         {"controller graph c.dot -o below/../c.dot", over("below/../c.dot", "c.dot")},
         {"bench frame fox.glb --quick --report fox.glb", over("fox.glb", "fox.glb")},
         {"bench baselines fox.gltf --json side.bin", over("side.bin", "side.bin of fox.gltf")},
         {"bench report records.jsonl --out records.jsonl", over("records.jsonl", "records.jsonl")},
         {"bench report records.jsonl --out page.html --plot records.jsonl", over("records.jsonl", "records.jsonl")}});
    const std::map<fs::path, std::string> before = contents();
    expect_refused(cases);
    EXPECT_EQ(contents(), before);
}

}  // namespace
}  // namespace throng
