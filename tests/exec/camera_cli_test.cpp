// `puckloop exec --camera`: real firmware takes a picture that nobody knew before, and what is refused.

#include "tests/camera/random_picture.h"
#include "tests/exec/command.h"
#include "tests/exec/rig.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <fstream>
#include <sstream>

using namespace puckloop;
using Catch::Contains;
using exec::one_line;
using exec::Outcome;
using exec::Workbench;

namespace {

/// Bytes that the chip sent from `from_s` on.
std::vector<unsigned> sent(const std::string& csv, double from_s) {
    std::vector<unsigned> bytes;
    std::istringstream lines(exec::text_of(csv));
    for (std::string line; std::getline(lines, line);) {
        const std::size_t first = line.find(",tx,");
        if (first == std::string::npos || std::stod(line) < from_s) continue;
        bytes.push_back(static_cast<unsigned>(std::stoul(line.substr(first + 4), nullptr, 16)));
    }
    return bytes;
}

}  // namespace

TEST_CASE("BTcom's I returns the very picture that the camera looks at") {
    const Workbench bench;
    RandomStream random(31, "btcom picture");
    const camera::Pixels pixels = tests::settled_pixels(random, 160, 120);
    std::string ppm = fmt::format("P6 {} {} 255\n", pixels.width, pixels.height);
    ppm.append(pixels.rgb.begin(), pixels.rgb.end());
    const std::string view = bench.file("view.ppm", ppm);
    const std::string ask = bench.file("ask.txt", "5 b7 00\n");
    for (const char* name : {"BTcom_default.hex", "BTcom_20_LIS_rev84.hex"}) {
        const auto image = exec::real_image(name);
        if (!image) return;
        const std::string log = bench.folder + "/" + name + ".logs";
        const Outcome run =
            bench.run(fmt::format("--board pic {} --camera {} --uart1 script:{} --log {} --seconds 6 --json",
                                  *image, view, ask, log));
        REQUIRE(run.status == 0);
        const std::vector<unsigned> bytes = sent(log + "/uart1.csv", 5.0);
        REQUIRE(bytes.size() == 3203);
        CHECK((bytes[0] == 1 && bytes[1] == 40 && bytes[2] == 40));
        // 40 x 40 of every eighth pixel of the middle.
        int wrong = 0;
        for (std::uint32_t y = 0; y < 40; ++y)
            for (std::uint32_t x = 0; x < 40; ++x) {
                const auto expected = tests::rgb565(pixels, 40 + 2 * x, 20 + 2 * y);
                const std::size_t at = 3 + 2 * (40 * y + x);
                wrong += bytes[at] != expected[0] || bytes[at + 1] != expected[1];
            }
        CHECK(wrong == 0);
        CHECK(exec::text_of(log + "/camera.csv").find(",rgb565,4,156,76,") != std::string::npos);
        CHECK(exec::text_of(log + "/camera.ppm") == "P6\n160 120\n255\n" + ppm.substr(ppm.find('\n') + 1));
        CHECK_THAT(run.out, Contains(R"("pictures":1)"));
    }
}

TEST_CASE("a camera that is not there, and pictures that are none") {
    const Workbench bench;
    const std::string image =
        bench.image("wait.hex", exec::assembled("        goto main\nmain:   bra main\n"));
    const std::string broken = bench.file("broken.ppm", "P6 10 10 255\nabc");
    for (const auto& [arguments, text] :
         {std::pair<std::string, const char*>{"--board rab x.hex --camera a.ppm", "rab has no camera"},
          {"--mcu dspic30f6014a " + image + " --camera-model po6030k", "has no camera"},
          {"--board pic " + image + " --camera " + bench.folder + "/none.ppm", "none.ppm: cannot be read"},
          {"--board pic " + image + " --camera " + broken, "pixels: the file is too short for 10 x 10"}}) {
        const Outcome run = bench.run(arguments);
        CHECK(run.status == 2);
        CHECK(one_line(run.err));
        CHECK_THAT(run.err, Contains(text));
    }
    CHECK(bench.run("--board pic " + image + " --camera-model none --seconds 0.01").status == 0);
}

TEST_CASE("the project's own camera firmware takes that picture, too") {
    const Workbench bench;
    RandomStream random(32, "own picture");
    const camera::Pixels pixels = tests::settled_pixels(random, 160, 120);
    std::string ppm = fmt::format("P6 {} {} 255\n", pixels.width, pixels.height);
    ppm.append(pixels.rgb.begin(), pixels.rgb.end());
    const std::string view = bench.file("view.ppm", ppm), ask = bench.file("ask.txt", "0.5 49\n1.5 49\n");
    const std::string image =
        bench.image("camera.hex", exec::assembled(exec::text_of(PUCKLOOP_FIRMWARE "/camera/camera.s")));
    // The image beside the source is what the source makes.
    CHECK(exec::text_of(image) == exec::text_of(PUCKLOOP_FIRMWARE "/camera/camera.hex"));
    const std::string log = bench.folder + "/logs";
    const Outcome run = bench.run("--board pic " + image + " --camera " + view + " --uart1 script:" + ask +
                                  " --log " + log + " --seconds 2.5 --strict");
    CHECK(run.status == 0);
    const std::vector<unsigned> bytes = sent(log + "/uart1.csv", 0.0);
    constexpr std::size_t kPicture = 3 + 2 * 40 * 40;
    REQUIRE(bytes.size() == 6 + 2 * kPicture);
    CHECK(std::equal(bytes.begin(), bytes.begin() + 6, "3030\r\n"));
    int wrong = 0;
    for (std::size_t first : {std::size_t{6}, 6 + kPicture})
        for (std::uint32_t i = 0; i < 1600; ++i) {
            const auto expected = tests::rgb565(pixels, 40 + 2 * (i % 40), 20 + 2 * (i / 40));
            wrong += bytes[first + 3 + 2 * i] != expected[0] || bytes[first + 4 + 2 * i] != expected[1];
        }
    CHECK(wrong == 0);
}
