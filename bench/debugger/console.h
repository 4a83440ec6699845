#pragma once
// `puckloop debug`: commands of a person, or of a script, at a debugged program.

#include "bench/debugger/session.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace puckloop::exec::debugger {

class Console {
  public:
    /// `interrupted`: Ctrl-C was pressed since it was asked last.
    Console(Session& session, std::function<bool()> interrupted);

    /// Does one line; false: the session is over. What is wrong with it is printed in one line, and counted.
    bool execute(const std::string& line);
    /// What the last word of `line` may become.
    std::vector<std::string> complete(const std::string& line) const;
    /// Where the program is.
    void show_place();
    std::size_t errors() const { return errors_; }

  private:
    using Words = std::vector<std::string>;
    struct Command {
        const char* name;
        const char* other;  ///< a shorter name, or ""
        const char* arguments;
        const char* about;
        void (Console::*act)(const Words& words);
    };
    static const std::vector<Command>& commands();
    static const Command* find(const std::string& name);

    void break_(const Words& words);
    void tbreak(const Words& words);
    void watch(const Words& words);
    void delete_(const Words& words);
    void info(const Words& words);
    void run(const Words& words);
    void step(const Words& words);
    void next(const Words& words);
    void stepi(const Words& words);
    void nexti(const Words& words);
    void finish(const Words& words);
    void until(const Words& words);
    void back(const Words& words);
    void back_into(const Words& words);
    void back_instruction(const Words& words);
    void reverse_continue(const Words& words);
    void backtrace_(const Words& words);
    void up(const Words& words);
    void down(const Words& words);
    void list(const Words& words);
    void disassemble(const Words& words);
    void print(const Words& words);
    void display(const Words& words);
    void set(const Words& words);
    void memory(const Words& words);
    void registers(const Words& words);
    void interrupts_(const Words& words);
    void time(const Words& words);
    void reset(const Words& words);
    void help(const Words& words);
    void quit(const Words& words);

    /// Moves `times`, as long as nothing else stops it, and shows where the program is.
    void move(const Words& words, const std::function<debug::Stop()>& once);
    void stopped(const debug::Stop& stop);
    std::string current_file() const;
    std::vector<Frame> frames(std::size_t most);
    void choose_frame(std::size_t frame);
    void list_around(const SourceLine& line);
    void added(int number);

    Session& session_;
    std::function<bool()> interrupted_;
    std::vector<std::string> displays_;
    std::size_t frame_ = 0;
    SourceLine listed_{};  ///< where the next `list` begins
    std::string last_;     ///< what an empty line repeats
    std::size_t errors_ = 0;
    bool over_ = false;
};

/// The whole command: reads standard input up to its end or `quit`; the exit status: 0, or 1 if a command of
/// a script failed. Throws InputError as Session does.
int run_debugger(const DebuggerOptions& options);

}  // namespace puckloop::exec::debugger
