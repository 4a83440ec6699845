#include "bench/debugger/line_editor.h"

#include <editline/readline.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <system_error>
#include <utility>

namespace puckloop::exec::debugger {

namespace {

constexpr const char* kPrompt = "(puckloop) ";
constexpr int kMostHistory = 1000;

// libedit's interface has no place for an object.
std::function<std::vector<std::string>(const std::string&)> g_complete;
std::vector<std::string> g_matches;
std::size_t g_next = 0;

char* next_match(const char*, int state) {
    if (state == 0) g_next = 0;
    return g_next < g_matches.size() ? ::strdup(g_matches[g_next++].c_str()) : nullptr;
}

char** matches(const char* word, int, int end) {
    rl_attempted_completion_over = 1;  // no files
    g_matches = g_complete(std::string(rl_line_buffer, static_cast<std::size_t>(end)));
    return g_matches.empty() ? nullptr : rl_completion_matches(word, next_match);
}

/// As XDG has it; empty where there is no home.
std::string history_place(const std::string& name) {
    namespace fs = std::filesystem;
    const char* state = std::getenv("XDG_STATE_HOME");
    const char* home = std::getenv("HOME");
    fs::path folder;
    if (state != nullptr && *state == '/')
        folder = state;
    else if (home != nullptr && *home == '/')
        folder = fs::path(home) / ".local" / "state";
    else
        return {};
    folder /= "puckloop";
    std::error_code error;
    fs::create_directories(folder, error);
    return error ? std::string() : (folder / name).string();
}

}  // namespace

LineEditor::LineEditor(std::function<std::vector<std::string>(const std::string& line)> complete,
                       const std::string& history)
    : interactive_(at_terminal()) {
    if (!interactive_) return;
    g_complete = std::move(complete);
    rl_readline_name = const_cast<char*>("puckloop");
    rl_initialize();
    rl_attempted_completion_function = matches;
    rl_completer_word_break_characters = const_cast<char*>(" ");
    stifle_history(kMostHistory);
    history_file_ = history_place(history);
    if (!history_file_.empty()) read_history(history_file_.c_str());
}

bool LineEditor::at_terminal() {
    return ::isatty(STDIN_FILENO) != 0 && ::isatty(STDOUT_FILENO) != 0;
}

LineEditor::~LineEditor() {
    if (!history_file_.empty()) write_history(history_file_.c_str());
}

std::optional<std::string> LineEditor::read() {
    if (interactive_) {
        char* line = readline(kPrompt);
        if (line == nullptr) {
            std::puts("");
            return std::nullopt;
        }
        std::string text = line;
        std::free(line);
        if (!text.empty()) add_history(text.c_str());
        return text;
    }
    std::string line;
    std::fflush(stdout);
    if (!std::getline(std::cin, line)) return std::nullopt;
    std::printf("%s%s\n", kPrompt, line.c_str());
    return line;
}

}  // namespace puckloop::exec::debugger
