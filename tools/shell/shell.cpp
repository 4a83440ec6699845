#include "tools/shell/shell.h"

#include "base/error.h"
#include "base/json.h"
#include "base/text/suggest.h"
#include "bench/debugger/line_editor.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

namespace puckloop::tools {

using nlohmann::json;

namespace {

/// The first word, and what follows it.
std::pair<std::string, std::string> split(const std::string& text) {
    const std::size_t begin = text.find_first_not_of(" \t");
    if (begin == std::string::npos) return {};
    const std::size_t end = text.find_first_of(" \t", begin);
    if (end == std::string::npos) return {text.substr(begin), {}};
    const std::size_t rest = text.find_first_not_of(" \t", end);
    std::string argument = rest == std::string::npos ? std::string() : text.substr(rest);
    argument.erase(argument.find_last_not_of(" \t\r") + 1);
    return {text.substr(begin, end - begin), argument};
}

std::string needed(const std::string& argument, const char* what) {
    if (argument.empty()) throw InputError("", "", fmt::format("{} is missing", what), "see help");
    return argument;
}

/// "20", "20 ms": a number is seconds, as the protocol has it.
json time_words(const std::string& text) {
    const bool bare = text.find_first_not_of("0123456789.") == std::string::npos;
    return bare ? json(text + " s") : json(text);
}

std::string frame_text(const json& frame) {
    std::string text =
        fmt::format("{:.9f}", static_cast<double>(frame.at("time_ps").get<std::int64_t>()) * 1e-12);
    for (const auto& one : frame.items())
        if (one.key() != "time_ps" && one.key() != "time_s")
            text +=
                fmt::format(" {}={}", one.key(),
                            one.value().is_string() ? one.value().get<std::string>() : one.value().dump());
    return text;
}

}  // namespace

struct Shell::Command {
    const char* name;
    const char* arguments;
    const char* help;
    void (*act)(Shell&, const std::string&);
};

struct ShellCommands {
    static std::span<const Shell::Command> all();

    static void step(Shell& shell, const std::string& argument) {
        shell.take(shell.ask({{"op", "step"}, {"for", time_words(argument.empty() ? "0.1" : argument)}}));
    }
    static void instruction(Shell& shell, const std::string& argument) {
        const json count = json::parse(argument.empty() ? "1" : argument, nullptr, false);
        if (!count.is_number_integer())
            throw InputError("", argument, "is no number of instructions", "1 to 100000");
        const json reply = shell.ask({{"op", "step"}, {"node", shell.board_}, {"instructions", count}});
        shell.take(reply);
        if (!reply.value("met", false)) throw InputError("", "stepi", "the board waits: 100 ms went by");
        where(shell, {});
    }
    static void run(Shell& shell, const std::string& argument) {
        if (argument.empty())
            shell.take(shell.ask({{"op", "step"}, {"for", "700 h"}}));
        else
            shell.take(shell.ask({{"op", "step"}, {"to", time_words(argument)}}));
    }
    static void until(Shell& shell, const std::string& argument) {
        const json reply = shell.ask({{"op", "step"},
                                      {"for", "60 s"},
                                      {"until", needed(argument, "a condition")},
                                      {"node", shell.board_}});
        shell.take(reply);
        if (!reply.value("met", false)) throw InputError("", "until", "did not hold within 60 s");
        if (reply.contains("frame")) std::printf("%s\n", frame_text(reply.at("frame")).c_str());
    }
    static void back(Shell& shell, const std::string& argument) {
        shell.take(shell.ask({{"op", "back"}, {"to", time_words(needed(argument, "a time"))}}));
    }
    static void board(Shell& shell, const std::string& argument) {
        if (!argument.empty()) return shell.choose(argument);
        for (const std::string& name : shell.boards_)
            std::printf("%s%s\n", name == shell.board_ ? "* " : "  ", name.c_str());
    }
    static void links(Shell& shell, const std::string&) {
        for (const std::string& name : shell.links_)
            std::printf("  %s\n", name.c_str());
    }
    static void where(Shell& shell, const std::string&) {
        const json reply = shell.ask({{"op", "where"}, {"node", shell.board_}});
        std::printf("%.6f s, %s: PC 0x%04x %s %s%s\n", shell.time_s_, shell.board_.c_str(),
                    reply.at("pc").get<unsigned>(), reply.value("place", "").c_str(),
                    reply.value("line", "").c_str(), reply.value("asleep", false) ? " waits" : "");
        for (const json& one : reply.at("instructions"))
            std::printf("%s 0x%04x  %s\n", one.at("pc") == reply.at("pc") ? "=>" : "  ",
                        one.at("pc").get<unsigned>(), one.at("text").get<std::string>().c_str());
    }
    static void read(Shell& shell, const std::string& argument) {
        std::string rest = needed(argument, "what to read");
        while (!rest.empty()) {
            const auto [name, others] = split(rest);
            const json reply = shell.ask({{"op", "read"}, {"node", shell.board_}, {"what", name}});
            std::printf("%s = %s\n", name.c_str(), reply.value("text", "").c_str());
            rest = others;
        }
    }
    static void write(Shell& shell, const std::string& argument) {
        const auto [name, value] = split(needed(argument, "what to write"));
        std::size_t end = 0;
        unsigned long long number = 0;
        try {
            if (needed(value, "a value").front() != '-') number = std::stoull(value, &end, 0);
        } catch (const std::exception&) {
            end = 0;
        }
        if (end == 0 || end != value.size())
            throw InputError("", value, "is no number", "such as 12 or 0x4e");
        shell.ask({{"op", "write"}, {"node", shell.board_}, {"what", name}, {"value", number}});
    }
    static void act(Shell& shell, const std::string& argument) {
        shell.ask({{"op", "act"}, {"command", needed(argument, "a command of `puckloop act`")}});
    }
    static void fault(Shell& shell, const std::string& argument) {
        shell.take(shell.ask({{"op", "fault"}, {"fault", needed(argument, "a fault")}}));
    }
    static void type(Shell& shell, const std::string& argument) {
        const auto [link, rest] = split(needed(argument, "a line"));
        const auto [from, typed] = split(needed(rest, "the end that is typed at"));
        std::string text = needed(typed, "what to type");
        if (text.size() > 1 && text.front() == '"' && text.back() == '"') {
            const json quoted = json::parse(text, nullptr, false);
            if (!quoted.is_string()) throw InputError("", text, "is no text", R"("d,100,100\r")");
            text = quoted.get<std::string>();
        }
        shell.take(shell.ask({{"op", "type"}, {"link", link}, {"from", from}, {"text", text}}));
    }
    static void flash(Shell& shell, const std::string& argument) {
        const auto file = std::filesystem::absolute(needed(argument, "a file"));
        shell.take(shell.ask({{"op", "flash"}, {"node", shell.board_}, {"file", file.string()}}));
    }
    static void save(Shell& shell, const std::string& argument) {
        // The run may have been started in another folder.
        const auto file = std::filesystem::absolute(needed(argument, "a file"));
        shell.ask({{"op", "save"}, {"file", file.string()}});
    }
    /// With arguments: frames like this are kept from now on. Without: those that came since.
    static void frames(Shell& shell, const std::string& argument) {
        if (!argument.empty()) {
            shell.ask({{"op", "capture"}, {"frame", argument}});
            shell.captures_ = true;
            return;
        }
        if (!shell.captures_)
            throw InputError("", "frames", "nothing is captured", "frames link=robot0.uart, say, before it");
        const json reply = shell.ask(json::object({{"op", "frames"}}));
        for (const json& frame : reply.at("frames"))
            std::printf("%s\n", frame_text(frame).c_str());
    }
    static void end(Shell& shell, const std::string&) { shell.finish(); }
    static void help(Shell&, const std::string& argument) {
        for (const Shell::Command& command : all())
            if (argument.empty() || argument == command.name)
                std::printf("%-6s %-22s %s\n", command.name, command.arguments, command.help);
    }
};

std::span<const Shell::Command> ShellCommands::all() {
    static const std::array commands{
        Shell::Command{"step", "[TIME]", "on by so much (100 ms)", step},
        Shell::Command{"stepi", "[N]", "on by instructions of the board (1), and where it then is",
                       instruction},
        Shell::Command{"run", "[TIME]", "on to a time; to the end", run},
        Shell::Command{"until", "CONDITION",
                       "on, at most 60 s: TMR1 >= 9, text \"ok\", frame link=robot0.uart value=4e", until},
        Shell::Command{"back", "TIME", "to an earlier time; what was done since is taken back", back},
        Shell::Command{"board", "[NAME]", "the board that read, write, where are about; all of them", board},
        Shell::Command{"links", "", "names for frames and faults", links},
        Shell::Command{"where", "", "where the board's program is", where},
        Shell::Command{"read", "WHAT...", "TMR1, U2STA.TRMT, a variable, 0x850:4", read},
        Shell::Command{"write", "WHAT VALUE", "a register before the next instruction, memory at once",
                       write},
        Shell::Command{"act", "COMMAND", "as `puckloop act`: move can to 10 cm, 0 cm", act},
        Shell::Command{"fault", "KIND KEY=VALUE...",
                       "as --fault, from now on: drop link=robot0.uart begin=2s", fault},
        Shell::Command{
            "type", "LINK FROM TEXT",
            "into a line as that end, \\r and \\n in \"...\": type robot0.uart1 robot0.uart1 \"v\\r\"", type},
        Shell::Command{"flash", "FILE", "another image into the board's chip, which is then reset", flash},
        Shell::Command{"frames", "[KEY=VALUE...]", "keep frames like this from now on; show those kept",
                       frames},
        Shell::Command{"save", "FILE", "a snapshot, for `puckloop run --from`", save},
        Shell::Command{"end", "", "programs get their end signal", end},
        Shell::Command{"help", "[COMMAND]", "this list", help}};
    return commands;
}

Shell::Shell(const std::filesystem::path& results) : run_(results) {
    const json greeting = json::parse(run_.greeting());
    boards_ = greeting.at("boards").get<std::vector<std::string>>();
    for (const json& link : greeting.at("links"))
        links_.push_back(link.at("name"));
    time_s_ = greeting.value("time_s", 0.0);
    if (!boards_.empty()) board_ = boards_.front();
}

json Shell::ask(json request) {
    json reply =
        json::parse(run_.ask(request.dump(-1, ' ', false, json::error_handler_t::replace)), nullptr, false);
    if (!reply.is_object()) throw RunError("a reply of the run that is none");
    if (!reply.value("ok", false)) throw InputError("", "", reply.value("error", "refused"));
    return reply;
}

/// Shows where a step has led.
void Shell::take(const json& reply) {
    time_s_ = reply.value("time_s", time_s_);
    for (const json& act : reply.value("acts", json(json::array()))) {
        const bool done = act.contains("done");
        const std::string answer =
            done ? fmt::format("done at {:.3f} s", act.value("at_s", 0.0)) : act.value("refused", "");
        std::printf("%s: %s\n", act.value("act", "").c_str(), answer.c_str());
        if (!done) ++refused_;
    }
    if (reply.value("ended", false)) {
        over_ = true;
        std::printf("the run is over: %s\n", reply.value("ended_why", "").c_str());
    } else {
        std::printf("%.6f s\n", time_s_);
    }
}

void Shell::choose(const std::string& board) {
    if (std::find(boards_.begin(), boards_.end(), board) == boards_.end()) {
        const std::vector<std::string_view> known(boards_.begin(), boards_.end());
        throw InputError("", board, "is no board of the run",
                         fmt::format("one of {}{}", fmt::join(boards_, ", "), did_you_mean(board, known)));
    }
    board_ = board;
}

bool Shell::execute(const std::string& line) {
    auto [name, argument] = split(line);
    if (name.empty()) std::tie(name, argument) = split(last_);
    if (name.empty() || name.starts_with("#")) return true;
    last_ = name == "step" || name == "until" ? name + " " + argument : std::string();
    try {
        const auto commands = ShellCommands::all();
        const auto command = std::find_if(commands.begin(), commands.end(),
                                          [&](const Command& one) { return name == one.name; });
        if (command == commands.end()) {
            std::vector<std::string_view> names;
            for (const Command& one : commands)
                names.emplace_back(one.name);
            throw InputError("", "", fmt::format("no command '{}'", name),
                             "see help" + did_you_mean(name, names));
        }
        command->act(*this, argument);
    } catch (const InputError& error) {
        ++refused_;
        std::printf("%s\n", error.what());
    } catch (const json::exception&) {
        throw RunError("a reply of the run lacks something");
    }
    std::fflush(stdout);
    return !over_;
}

std::vector<std::string> Shell::complete(const std::string& line) const {
    const std::size_t space = line.rfind(' ');
    const std::string word = space == std::string::npos ? line : line.substr(space + 1);
    std::vector<std::string> all;
    if (space == std::string::npos) {
        for (const Command& one : ShellCommands::all())
            all.emplace_back(one.name);
    } else {
        const std::string name = split(line).first;
        if (name == "board" || name == "until") all = boards_;
        if (name == "frames" || name == "fault" || name == "until")
            for (const std::string& link : links_)
                all.push_back("link=" + link);
        if (name == "help")
            for (const Command& one : ShellCommands::all())
                all.emplace_back(one.name);
    }
    std::erase_if(all, [&](const std::string& one) { return !one.starts_with(word); });
    return all;
}

void Shell::finish() {
    if (over_) return;
    over_ = true;
    const json reply = ask(json::object({{"op", "end"}}));
    std::printf("the run is over: %s\n", reply.value("ended_why", "").c_str());
}

int run_shell(const std::filesystem::path& results) {
    Shell shell(results);
    exec::debugger::LineEditor editor([&](const std::string& line) { return shell.complete(line); },
                                      "shell_history");
    if (editor.interactive()) std::printf("the run stands still; `help` lists the commands\n");
    while (const std::optional<std::string> line = editor.read())
        if (!shell.execute(*line)) break;
    shell.finish();
    return editor.interactive() || shell.refused() == 0 ? 0 : 1;
}

}  // namespace puckloop::tools
