// `monitor ...`: what a firmware engineer asks that no debugger has a command for.

#include "debug/gdb/gdb_session.h"

#include <fmt/format.h>

namespace puckloop::debug {

namespace {

constexpr std::string_view kHelp =
    "monitor reset          a pulse on the reset pin\n"
    "monitor cycles         instruction cycles and instructions since power-up\n"
    "monitor time           simulated time\n"
    "monitor sfr NAME       a register by its data-sheet name, with its fields\n"
    "monitor sfr            their names\n"
    "monitor stats          resets, traps, warnings so far\n"
    "monitor help           this text\n";

std::string special(const DebugChip& chip, std::string name) {
    for (char& c : name)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 0x20);
    const auto found = chip.special(name);
    if (!found) return fmt::format("{} has no register {}; 'monitor sfr' lists them\n", chip.name(), name);
    std::string text =
        fmt::format("{} (0x{:04x}) = 0x{:0{}x}", name, found->address, found->value, found->bits / 4);
    for (const DebugChip::Field& field : found->fields)
        text += fmt::format(" {}={}", field.name, field.value);
    return text + "\n";
}

std::string names(const DebugChip& chip) {
    constexpr std::size_t kColumns = 72;
    std::string text, line;
    for (const std::string& name : chip.special_names()) {
        if (line.size() + name.size() > kColumns) {
            text += line + "\n";
            line.clear();
        }
        line += (line.empty() ? "" : " ") + name;
    }
    return text + line + "\n";
}

}  // namespace

std::string monitor(Debuggee& debuggee, std::string_view text) {
    while (!text.empty() && text.back() == ' ')
        text.remove_suffix(1);
    const DebugChip& chip = debuggee.chip();
    if (text == "reset") {
        if (const std::string why = debuggee.frozen(); !why.empty()) return why + "\n";
        debuggee.press_reset();
        return "reset\n";
    }
    if (text == "cycles")
        return fmt::format("{} cycles, {} instructions\n", chip.cycle(), chip.instructions());
    if (text == "time") return fmt::format("{:.9f} s\n", debuggee.seconds());
    if (text == "stats") return debuggee.summary();
    if (text == "sfr") return names(chip);
    if (text.starts_with("sfr ")) return special(chip, std::string(text.substr(4)));
    if (text == "help" || text.empty()) return std::string(kHelp);
    return fmt::format("no command '{}'\n{}", text, kHelp);
}

}  // namespace puckloop::debug
