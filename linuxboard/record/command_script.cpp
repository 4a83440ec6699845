#include "linuxboard/record/command_script.h"

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace puckloop::control {

namespace {

constexpr double kMostSteps = 32767;  // what the record's field holds

[[noreturn]] void refuse(const std::filesystem::path& file, int line, const char* what) {
    throw std::runtime_error(file.string() + ":" + std::to_string(line) + ": " + what);
}

}  // namespace

std::vector<ScriptedCommand> read_command_script(const std::filesystem::path& file) {
    std::ifstream in(file);
    if (!in) throw std::runtime_error(file.string() + ": cannot be read");
    std::vector<ScriptedCommand> commands;
    std::string text;
    for (int line = 1; std::getline(in, text); ++line) {
        std::istringstream words(text.substr(0, text.find('#')));
        ScriptedCommand command{};
        if (!(words >> command.seconds)) {
            if (words.clear(), words >> std::ws, words.eof()) continue;
            refuse(file, line, "expected seconds, left and right steps/s");
        }
        if (!(words >> command.left >> command.right) || !(words >> std::ws).eof())
            refuse(file, line, "expected seconds, left and right steps/s");
        if (command.left < -kMostSteps || command.left > kMostSteps || command.right < -kMostSteps ||
            command.right > kMostSteps)
            refuse(file, line, "a speed is beyond +-32767 steps/s");
        if (!commands.empty() && command.seconds < commands.back().seconds)
            refuse(file, line, "times must not go back");
        commands.push_back(command);
    }
    if (commands.empty()) refuse(file, 1, "no command");
    return commands;
}

}  // namespace puckloop::control
