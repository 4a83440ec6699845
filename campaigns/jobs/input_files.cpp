#include "campaigns/jobs/input_files.h"

#include "base/sha256.h"
#include "run/files/program_path.h"

namespace puckloop::jobs {

namespace fs = std::filesystem;

void InputFiles::add(const fs::path& file) {
    if (file.empty()) return;
    const fs::path path = tools::full_path(file);
    std::error_code error;
    if (fs::is_regular_file(path, error)) files_[path.string()] = sha256_of_file(path);
}

void InputFiles::add_command(const std::vector<std::string>& words, const fs::path& folder) {
    if (words.empty()) return;
    add(tools::find_program(words[0], folder));
    for (std::size_t i = 1; i < words.size(); ++i)
        add(words[i]);
}

void InputFiles::add_scenario(const scenarios::Scenario& scenario) {
    const fs::path folder = scenario.file.parent_path();
    for (const fs::path& file : scenario.files)
        add(file);
    for (const physics::Patch& patch : scenario.world.patches)
        if (!patch.image.empty()) files_["image of " + patch.name] = sha256_text(patch.image.text());
    for (const scenarios::RobotBoards& robot : scenario.robots) {
        add(robot.pic.firmware);
        if (robot.rab) add(robot.rab->firmware);
        if (robot.linux_board) add_command(robot.linux_board->command, folder);
    }
    for (const scenarios::TamBoard& tam : scenario.tams)
        add(tam.firmware.empty() ? tools::own_image("tam") : tam.firmware);
    if (scenario.coordinator && scenario.coordinator->program)
        add_command(scenario.coordinator->program->command, folder);
}

}  // namespace puckloop::jobs
