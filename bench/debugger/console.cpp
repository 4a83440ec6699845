#include "bench/debugger/console.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "bench/debugger/line_editor.h"

#include <fmt/format.h>

#include <atomic>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <sstream>

namespace puckloop::exec::debugger {

using debug::Stop;

namespace {

std::vector<std::string> words_of(const std::string& line) {
    std::istringstream stream(line);
    std::vector<std::string> words;
    for (std::string word; stream >> word;)
        words.push_back(word);
    return words;
}

/// Where a script that gives no end of its own ends, in simulated time; as `exec` has it.
constexpr double kScriptSeconds = 60.0;

std::atomic<bool> g_stop{false};

void on_stop_signal(int) {
    g_stop = true;
}

}  // namespace

Console::Console(Session& session, std::function<bool()> interrupted)
    : session_(session), interrupted_(std::move(interrupted)) {
    session_.debugged().wants_stop = interrupted_;
}

const std::vector<Console::Command>& Console::commands() {
    static const std::vector<Command> list{
        {"break", "b", "PLACE",
         "stop at FILE:LINE, LINE, a function, 0xADDRESS; or when REGISTER.FIELD changes [=VALUE]",
         &Console::break_},
        {"tbreak", "tb", "PLACE", "the same, once", &Console::tbreak},
        {"watch", "", "WHAT [r|w|rw]", "stop after an instruction that writes (or reads) there",
         &Console::watch},
        {"delete", "", "[N ...]", "remove break- and watchpoints, all without numbers", &Console::delete_},
        {"info", "i", "[breakpoints | registers]", "break- and watchpoints, and what is known of the program",
         &Console::info},
        {"continue", "c", "[N]", "go on (run, r); past the next N-1 stops", &Console::run},
        {"run", "r", "", "the same", &Console::run},
        {"step", "s", "[N]", "to the next line, into functions", &Console::step},
        {"next", "n", "[N]", "to the next line, over functions", &Console::next},
        {"stepi", "si", "[N]", "one instruction", &Console::stepi},
        {"nexti", "ni", "[N]", "one instruction, over a call", &Console::nexti},
        {"finish", "fin", "", "until the chosen frame's function has returned", &Console::finish},
        {"until", "u", "PLACE", "go on to a place", &Console::until},
        {"back", "", "[N]", "to the line before, over functions", &Console::back},
        {"back-into", "", "[N]", "to the line before, whatever its function", &Console::back_into},
        {"back-instruction", "bi", "[N]", "to the instruction before", &Console::back_instruction},
        {"reverse-continue", "rc", "[N]", "back to where the program would have stopped last",
         &Console::reverse_continue},
        {"backtrace", "bt", "", "who called whom", &Console::backtrace_},
        {"up", "", "[N]", "to the caller's frame", &Console::up},
        {"down", "", "[N]", "the other way", &Console::down},
        {"list", "l", "[PLACE]", "source lines", &Console::list},
        {"disassemble", "x", "[/COUNT] [PLACE]",
         "instructions of a function, or so many from there or an address", &Console::disassemble},
        {"print", "p", "[/xdust] WHAT ...", "variable[:BYTES][INDEX], register, register.field, 0xADDRESS",
         &Console::print},
        {"display", "", "[WHAT]", "print it at each stop; without WHAT none any more", &Console::display},
        {"set", "", "WHAT = NUMBER", "change it", &Console::set},
        {"memory", "m", "WHAT [BYTES]", "bytes of data space", &Console::memory},
        {"registers", "regs", "", "the core's registers", &Console::registers},
        {"interrupts", "", "", "which are enabled and which are flagged", &Console::interrupts_},
        {"time", "", "", "simulated time, cycles, instructions", &Console::time},
        {"reset", "", "", "a pulse on the reset pin", &Console::reset},
        {"help", "h", "[COMMAND]", "this list", &Console::help},
        {"quit", "q", "", "leave", &Console::quit},
    };
    return list;
}

const Console::Command* Console::find(const std::string& name) {
    const Command* only = nullptr;
    std::size_t fitting = 0;
    for (const Command& command : commands()) {
        if (name == command.name || name == command.other) return &command;
        if (std::string_view(command.name).starts_with(name)) {
            only = &command;
            ++fitting;
        }
    }
    return fitting == 1 ? only : nullptr;
}

bool Console::execute(const std::string& line) {
    Words words = words_of(line);
    if (words.empty()) {
        if (last_.empty()) return true;
        words = words_of(last_);
    }
    if (words[0].starts_with("#")) return true;
    last_.clear();
    // print/x NAME is print /x NAME.
    if (const std::size_t slash = words[0].find('/'); slash != std::string::npos && slash > 0) {
        words.insert(words.begin() + 1, words[0].substr(slash));
        words[0].resize(slash);
    }
    try {
        const Command* command = find(words[0]);
        if (command == nullptr) {
            std::vector<std::string_view> names;
            for (const Command& one : commands())
                names.emplace_back(one.name);
            throw InputError("", "", fmt::format("no command '{}'", words[0]),
                             "see help" + did_you_mean(words[0], names));
        }
        (this->*command->act)(words);
    } catch (const InputError& error) {
        ++errors_;
        std::printf("%s\n", error.what());
    }
    std::fflush(stdout);
    return !over_;
}

std::vector<std::string> Console::complete(const std::string& line) const {
    const std::size_t space = line.rfind(' ');
    const std::string word = space == std::string::npos ? line : line.substr(space + 1);
    std::vector<std::string> all;
    if (space == std::string::npos) {
        for (const Command& command : commands())
            all.emplace_back(command.name);
    } else {
        const std::vector<std::string> words = words_of(line);
        const Command* command = words.empty() ? nullptr : find(words[0]);
        const std::string kind = command == nullptr ? "" : command->arguments;
        if (kind.find("PLACE") != std::string::npos) all = session_.program().function_names();
        if (kind.find("WHAT") != std::string::npos || kind == "PLACE")
            for (std::string& name : place_names(session_.chip(), session_.program()))
                all.push_back(std::move(name));
        if (kind == "[COMMAND]")
            for (const Command& one : commands())
                all.emplace_back(one.name);
    }
    std::erase_if(all, [&](const std::string& name) { return !name.starts_with(word); });
    return all;
}

int run_debugger(const DebuggerOptions& options) {
    DebuggerOptions bounded = options;
    // A script cannot press Ctrl-C.
    if (!LineEditor::at_terminal() && !bounded.exec.seconds) bounded.exec.seconds = kScriptSeconds;
    Session session(bounded);
    struct sigaction action {};
    action.sa_handler = on_stop_signal;
    sigaction(SIGINT, &action, nullptr);
    Console console(session, [] { return g_stop.exchange(false); });
    LineEditor editor([&](const std::string& line) { return console.complete(line); });
    if (editor.interactive()) std::printf("%s; `help` lists the commands\n", options.exec.image.c_str());
    console.show_place();
    while (const std::optional<std::string> line = editor.read())
        if (!console.execute(*line)) break;
    session.finish();
    return editor.interactive() || console.errors() == 0 ? 0 : 1;
}

}  // namespace puckloop::exec::debugger
