#include "tools/cli/option_sections.h"

#include <array>
#include <string>
#include <string_view>

namespace puckloop::tools {

namespace {

struct Section {
    std::string_view command, first_option, heading;
};

constexpr std::array kSections{Section{"run", "firmware", "What runs"},
                               Section{"run", "in-process", "Placement"},
                               Section{"run", "events", "Faults and events"},
                               Section{"run", "duration", "Time"},
                               Section{"run", "trace-format", "Results"},
                               Section{"run", "gdb", "Debugging"},
                               Section{"run", "control", "Results"},
                               Section{"run", "save-state", "Saved states"},
                               Section{"run", "list-parameters", "Results"},
                               Section{"exec", "mcu", "What is on the bench"},
                               Section{"exec", "seconds", "Time"},
                               Section{"exec", "gdb", "Debugging and profiles"},
                               Section{"exec", "uart1", "What is plugged in"},
                               Section{"exec", "stimulus", "Inputs"},
                               Section{"exec", "log", "Results"},
                               Section{"exec", "seed", "The board"},
                               Section{"exec", "realtime", "Speed"},
                               Section{"exec", "no-skip", "Speed"}};
constexpr std::string_view kMessages[] = {"verbose", "log-level", "log-file"};

bool is_named(const CLI::Option& option, std::string_view name) {
    for (const std::string& one : option.get_lnames())
        if (one == name) return true;
    return false;
}

}  // namespace

void set_sections(CLI::App& command) {
    std::string heading;
    for (CLI::Option* option : command.get_options()) {
        for (const Section& section : kSections)
            if (section.command == command.get_name() && is_named(*option, section.first_option))
                heading = section.heading;
        bool message = false;
        for (const std::string_view name : kMessages)
            message = message || is_named(*option, name);
        if (message) option->group("Messages");
        const bool hidden = option->get_group().empty(), help = is_named(*option, "help");
        if (!message && !hidden && !help && !heading.empty()) option->group(heading);
    }
}

}  // namespace puckloop::tools
