// Includes, variables and images: what a scenario is put together from.

#include "base/error.h"
#include "scenarios/reader/read_scenario.h"
#include "scenarios/values/png_floor.h"
#include "tests/scenarios/temporary_file.h"

#include <catch2/catch.hpp>
#include <png.h>

#include <filesystem>
#include <fstream>

using namespace puckloop;
using namespace puckloop::scenarios;

namespace {

namespace fs = std::filesystem;

/// A folder that lives as long as the test.
struct Folder {
    fs::path path;
    Folder() {
        std::string name = (fs::temp_directory_path() / "puckloop_compose_XXXXXX").string();
        REQUIRE(::mkdtemp(name.data()) != nullptr);
        path = name;
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    fs::path write(const std::string& name, const std::string& text) const {
        fs::create_directories((path / name).parent_path());
        std::ofstream(path / name) << text;
        return path / name;
    }
    fs::path png(const std::string& name, unsigned width, unsigned height, std::vector<unsigned char> bytes,
                 unsigned format) const {
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        image.width = width;
        image.height = height;
        image.format = format;
        REQUIRE(png_image_write_to_file(&image, (path / name).c_str(), 0, bytes.data(), 0, nullptr) != 0);
        return path / name;
    }
};

const std::string kRobot = "[[robot]]\nposition = [\"0 m\", \"0 m\"]\n[robot.pic]\nfirmware = \"own\"\n";
const std::string kRoom = "[arena]\nsize = [\"1 m\", \"1 m\"]\n";

std::string problem_of(const fs::path& file, const Settings& settings = {}) {
    try {
        read_scenario(file, settings);
    } catch (const InputError& error) {
        const std::string what = error.what();
        const auto folder = what.find(file.parent_path().string());
        return folder == 0 ? what.substr(file.parent_path().string().size() + 1) : what;
    }
    return "accepted";
}

}  // namespace

TEST_CASE("an included file gives its tables, and the including one has the last word") {
    const Folder folder;
    folder.write("rooms/arena.toml", "[arena]\nsize = [\"1 m\", \"1 m\"]\nwall_height = \"8 cm\"\n"
                                     "[[lamp]]\ncentre = [\"0 m\", \"1 m\"]\n");
    const auto file =
        folder.write("run.toml", "include = \"rooms/arena.toml\"\n[arena]\nwall_height = \"5 cm\"\n"
                                 "[[lamp]]\ncentre = [\"0 m\", \"-1 m\"]\n" +
                                     kRobot);
    const Scenario scenario = read_scenario(file);
    CHECK(scenario.world.arena.wall_height == Approx(0.05));
    CHECK(scenario.world.arena.corners[2].x == Approx(0.5));
    REQUIRE(scenario.world.lamps.size() == 2);
    CHECK(scenario.world.lamps[0].y == Approx(1.0));
    CHECK(scenario.files == std::vector<fs::path>{file, folder.path / "rooms/arena.toml"});
}

TEST_CASE("what is wrong in an included file is said with that file and its line") {
    const Folder folder;
    folder.write("arena.toml", "\n[arena]\nsize = [\"1 m\", \"1 m\"]\nsise = 3\n");
    CHECK(problem_of(folder.write("run.toml", "include = \"arena.toml\"\n" + kRobot))
              .starts_with("arena.toml: line 4: "));
    CHECK(problem_of(folder.write("a.toml", "include = \"b.toml\"\n" + kRobot))
              .starts_with("a.toml: line 1: there is no file"));
    folder.write("c.toml", "include = \"d.toml\"\n");
    CHECK(problem_of(folder.write("d.toml", "include = [\"c.toml\"]\n")).find("includes itself") !=
          std::string::npos);
}

TEST_CASE("variables stand for values and parts of texts, and --set replaces them") {
    const Folder folder;
    const auto file = folder.write("run.toml", "[variables]\nside = 2\nheight = \"7 cm\"\nwalls = true\n"
                                               "[arena]\nsize = [\"${side} m\", \"$${side} m\"]\n" +
                                                   kRobot);
    CHECK(problem_of(file).find("${side} m") != std::string::npos);  // $${ is no variable
    const auto good =
        folder.write("good.toml", "[variables]\nside = 2\nheight = \"7 cm\"\nwalls = true\n"
                                  "[arena]\nsize = [\"${side} m\", \"1 m\"]\nwall_height = \"${height}\"\n"
                                  "walls = \"${walls}\"\n" +
                                      kRobot);
    const Scenario plain = read_scenario(good);
    CHECK(plain.world.arena.corners[2].x == Approx(1.0));
    CHECK(plain.world.arena.wall_height == Approx(0.07));
    CHECK(plain.world.arena.walls);
    Settings settings;
    settings.variables = {"side=3", "height=9 cm", "walls=false"};
    const Scenario other = read_scenario(good, settings);
    CHECK(other.world.arena.corners[2].x == Approx(1.5));
    CHECK(other.world.arena.wall_height == Approx(0.09));
    CHECK_FALSE(other.world.arena.walls);
}

TEST_CASE("a variable that is not there, or that cannot be such, is one line") {
    const Folder folder;
    const auto file = folder.write(
        "run.toml", "[variables]\nside = 2\n[arena]\nsize = [\"${sides} m\", \"1 m\"]\n" + kRobot);
    CHECK(problem_of(file).starts_with("run.toml: line 4: there is no variable 'sides'"));
    Settings settings;
    settings.variables = {"sid=3"};
    CHECK(problem_of(file, settings).starts_with("run.toml: has no variable 'sid'"));
    settings.variables = {"side=wide"};
    CHECK(problem_of(file, settings).starts_with("--set: side cannot be 'wide'"));
    settings.variables = {"side"};
    CHECK(problem_of(file, settings).starts_with("--set: 'side' is no assignment"));
    // Without [variables] a text is what it says.
    CHECK(problem_of(folder.write("plain.toml",
                                  kRoom + kRobot + "[robot.linux]\nprogram = [\"x\", \"${HOME}\"]\n")) ==
          "accepted");
}

TEST_CASE("a PNG image on the floor: the first row is the furthest north, grey and colour") {
    const Folder folder;
    // Left column black, right column white; upper right red.
    folder.png("floor.png", 2, 2, {0, 0, 0, 255, 0, 0, 0, 0, 0, 255, 255, 255}, PNG_FORMAT_RGB);
    const auto file =
        folder.write("run.toml", kRoom +
                                     "[[floor_patch]]\ncentre = [\"0 m\", \"0 m\"]\nimage = \"floor.png\"\n"
                                     "size = [\"1 m\", \"1 m\"]\n" +
                                     kRobot);
    const Scenario scenario = read_scenario(file);
    REQUIRE(scenario.world.patches.size() == 1);
    const physics::FloorImage& image = scenario.world.patches[0].image;
    CHECK(image.at(0.9, 0.9) == physics::Rgb{255, 0, 0});
    CHECK(image.at(0.9, 0.1) == physics::Rgb{255, 255, 255});
    CHECK(image.at(0.1, 0.9) == physics::Rgb{0, 0, 0});
    CHECK(physics::grey_of(image.at(0.9, 0.9)) == Approx(0.299));
    CHECK(physics::FloorImage::from_text(image.text()) == image);
    const physics::World again = physics::from_json(physics::to_json(scenario.world));
    CHECK(again.patches[0].image == image);

    const auto grey = folder.png("grey.png", 3, 1, {0, 128, 255}, PNG_FORMAT_GRAY);
    CHECK(read_png(grey).at(0.5, 0.5) == physics::Rgb{128, 128, 128});
}

TEST_CASE("an image of other proportions, damaged or missing is refused with its place") {
    const Folder folder;
    folder.png("floor.png", 2, 1, {0, 0, 0, 255, 0, 0}, PNG_FORMAT_RGB);
    const std::string patch = "[[floor_patch]]\ncentre = [\"0 m\", \"0 m\"]\nsize = [\"1 m\", \"1 m\"]\n";
    CHECK(problem_of(folder.write("a.toml", kRoom + patch + "image = \"floor.png\"\n" + kRobot))
              .starts_with("a.toml: line 5: floor_patch 1: an image of 2 x 1 pixels on 1 m x 1 m"));
    CHECK(problem_of(folder.write("b.toml", kRoom + patch + "image = \"floor.png\"\nstretch = true\n" +
                                                kRobot)) == "accepted");
    CHECK(problem_of(folder.write("c.toml", kRoom + patch + "image = \"flor.png\"\n" + kRobot))
              .starts_with("flor.png: there is no such file"));
    folder.write("text.png", "no picture");
    CHECK(problem_of(folder.write("d.toml", kRoom + patch + "image = \"text.png\"\n" + kRobot))
              .starts_with("text.png: cannot be read as PNG"));
}
