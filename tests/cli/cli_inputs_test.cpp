// No command writes over what it reads, by whatever name.
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
        for (const char* name : {"c.dot", "frame_settings.json"}) write(name, read_file(file("c.json")));
        write("records.jsonl", R"({"bench": "scan", "experiment": "levels", "method": "serial", "levels": 15, )"
                               R"("median_ms": 3, "copy_ms": 2, "times_copy": 1.5})"
                               "\n");
        fs::create_directory(file("below"));
        fs::create_hard_link(file("fox.glb"), file("hard.glb"));
        fs::create_symlink("fox.glb", file("soft.glb"));
        fs::create_directory(file("film.mp4.frames"));
        fs::create_hard_link(file("fox.glb"), file("film.mp4.frames/000002.png"));
        fs::create_hard_link(file("fox.glb"), file("frame_03.png"));
    }

    static std::map<fs::path, std::string> contents() {
        std::map<fs::path, std::string> of_files;
        for (const auto& entry : fs::recursive_directory_iterator(folder_->path()))
            if (entry.is_regular_file()) of_files[entry.path()] = read_file(entry.path());
        return of_files;
    }
};

TEST_F(CliInputs, AreNotWrittenOver) {
    const std::string fox = file("fox.glb"), gltf = file("fox.gltf"), side = file("side.bin");
    const std::string image = file("skin of fox.png"), controller = file("c.json"), graph = file("below/../c.dot");
    const std::string records = file("records.jsonl"), page = file("page.html");
    const std::string film = file("film.mp4"), frames = file("frame_%02d.png"), settings = file("frame_settings.json");
    const auto over = [](const std::string& out, const std::string& input) {
        return "throng: " + out + ": would be written over " + input + ", which this command reads";
    };
    std::vector<Refused> cases;
    for (const char* name : {"fox.glb", "hard.glb", "soft.glb", "below/../fox.glb", "below//..//fox.glb"}) {
        const std::string out = file(name);
        cases.push_back({{"render", fox, "--out", out}, over(out, fox)});
        cases.push_back({{"compile", fox, "--out", out}, over(out, fox)});
        cases.push_back({{"view", fox, "--after", "1", "--screenshot", out}, over(out, fox)});
    }
    for (const std::string& given : {controller, fox + "=" + controller})
        cases.push_back({{"render", fox, "--controller", given, "--out", controller}, over(controller, controller)});
    cases.insert(
        cases.end(),
        {{{"render", file("soft.glb"), "--out", fox}, over(fox, file("soft.glb"))},
         {{"render", fox, gltf, "--out", side}, over(side, "side.bin of " + gltf)},
         {{"render", gltf, "--out", image}, over(image, "skin%20of%20fox.png of " + gltf)},
         {{"compile", gltf, "--out", side}, over(side, "side.bin of " + gltf)},
         {{"render", fox, "--frames", "0:4", "--out", film}, over(film + ".frames/000002.png", fox)},
         {{"render", fox, "--frames", "0:4", "--shard", "0/2", "--out", frames}, over(file("frame_03.png"), fox)},
         {{"render", fox, "--controller", settings, "--frames", "0:2", "--out", frames}, over(settings, settings)},
         {{"view", fox, "--controller", controller, "--screenshot", controller}, over(controller, controller)},
         {{"view", fox, "--after", "1", "--dump", fox}, over(fox, fox)},
         {{"controller", "graph", file("c.dot"), "-o", graph}, over(graph, file("c.dot"))},
         {{"bench", "frame", fox, "--quick", "--report", fox}, over(fox, fox)},
         {{"bench", "baselines", gltf, "--json", side}, over(side, "side.bin of " + gltf)},
         {{"bench", "report", records, "--out", records}, over(records, records)},
         {{"bench", "report", records, "--out", page, "--plot", records}, over(records, records)}});
    const std::map<fs::path, std::string> before = contents();
    expect_refused(cases);
    EXPECT_EQ(contents(), before);
}

}  // namespace
}  // namespace throng
