#include "campaigns/engine/identity.h"

#include "base/sha256.h"
#include "cosim/resume/state_file.h"
#include "run/files/program_path.h"

#include <fmt/format.h>

namespace puckloop::faults {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// SHA-256 of a file; empty if there is no such file.
std::string hash_of(const fs::path& file) {
    std::error_code error;
    if (!fs::is_regular_file(file, error)) return {};
    return sha256_of_file(file);
}

class Inputs {
  public:
    void add(const fs::path& file) {
        if (file.empty()) return;
        const fs::path path = tools::full_path(file);
        if (std::string hash = hash_of(path); !hash.empty()) files[path.string()] = std::move(hash);
    }
    /// The program itself and those of its arguments that are files.
    void add_command(const std::vector<std::string>& words, const fs::path& folder) {
        if (words.empty()) return;
        add(tools::find_program(words[0], folder));
        for (std::size_t i = 1; i < words.size(); ++i)
            add(words[i]);
    }

    json files = json::object();
};

}  // namespace

std::string identity_of(const Campaign& campaign, const scenarios::Scenario& scenario) {
    Inputs inputs;
    const fs::path folder = scenario.file.parent_path();
    inputs.add(campaign.file);
    inputs.add(campaign.scenario);
    for (const scenarios::RobotBoards& robot : scenario.robots) {
        inputs.add(robot.pic.firmware);
        if (robot.rab) inputs.add(robot.rab->firmware);
        if (robot.linux_board) inputs.add_command(robot.linux_board->command, folder);
    }
    for (const scenarios::TamBoard& tam : scenario.tams)
        inputs.add(tam.firmware.empty() ? tools::own_image("tam") : tam.firmware);
    if (scenario.coordinator && scenario.coordinator->program)
        inputs.add_command(scenario.coordinator->program->command, folder);
    const json identity{{"files", inputs.files},
                        {"firmware", campaign.firmware},
                        {"program", campaign.program},
                        {"build", cosim::build_id()}};
    return identity.dump(-1, ' ', true, json::error_handler_t::replace);
}

}  // namespace puckloop::faults
