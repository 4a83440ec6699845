// docs/images.md: what third-party images do at each position of the selector or for each command, from runs
// over the folder that PUCKLOOP_IMAGES names. The file is made by this test and held to it.

#include "tests/images/trial.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

using namespace puckloop;
using images::Row;

namespace {

/// What became of a row: "seen", and whether it is what the source states.
struct Result {
    std::string seen;
    bool works = false;
};

Result result_of(const Row& row, const std::string& file) {
    images::Trial trial(file, row.setup);
    Result result;
    try {
        result = {row.see(trial), true};
    } catch (const images::Wrong& wrong) {
        result = {"NOT: " + wrong.seen, false};
    }
    if (const std::string troubles = trial.troubles(); !troubles.empty()) {
        result.seen += ";" + troubles;
        result.works = false;
    }
    return result;
}

std::string lines_of(const std::vector<Row>& rows, std::set<std::string>& absent) {
    std::string text = "| image | selector or command | its source says | seen |\n|---|---|---|---|\n";
    for (const Row& row : rows) {
        if (absent.contains(row.image)) continue;
        const auto file = exec::real_image(row.image);
        if (!file) {
            absent.insert(row.image);
            continue;
        }
        const Result result = result_of(row, *file);
        INFO(row.image << ", " << row.at << ": " << result.seen);
        CHECK(result.works);
        text += fmt::format("| {} | {} | {} | {} |\n", row.image, row.at, row.says, result.seen);
    }
    return text;
}

constexpr const char* kHead =
    "# Third-party images, one row for each position of the selector or command\n\n"
    "Made by a test (`tests/images`) from runs on the bench over the folder that `PUCKLOOP_IMAGES` names; "
    "`./puckloop test -C sweep -R images_table`\nruns it again. The images are the e-puck library's "
    "(programs "
    "BTcom, demo, DemoGCtronic-complete, bluetooth_mirror), ARGoS' and the\nrange-and-bearing board's. None "
    "of "
    "them touched a register without a model, none was trapped. Board revision 1.2 with a PO3030K "
    "unless\nthe row "
    "says otherwise. In the world and with other robots: [sound.md](sound.md), "
    "[scenario.md](scenario.md).\n\n";

}  // namespace

TEST_CASE("docs/images.md lists what third-party images do", "[.sweep]") {
    std::string text = kHead;
    std::set<std::string> absent;
    for (const auto& [title, rows] : {std::pair{"demoGCtronic", images::demo_gctronic_rows()},
                                      {"Demo", images::demo_rows()},
                                      {"BTcom", images::btcom_rows()},
                                      {"Others", images::other_rows()}})
        text += fmt::format("## {}\n\n{}\n", title, lines_of(rows, absent));
    text.pop_back();
    if (!absent.empty()) return;  // the message is there
    const std::string path = std::string(PUCKLOOP_SOURCE) + "/docs/images.md";
    if (std::getenv("PUCKLOOP_WRITE_IMAGES")) std::ofstream(path) << text;
    std::ifstream file(path);
    std::stringstream found;
    found << file.rdbuf();
    INFO("PUCKLOOP_WRITE_IMAGES=1 makes the file anew");
    const bool same = found.str() == text;
    CHECK(same);
}
