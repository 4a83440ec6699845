#pragma once
// A program under a debugger of our own: the bench with its chip, names, break- and watchpoints.

#include "bench/debugger/motion.h"
#include "bench/debugger/program.h"
#include "bench/debugger/values.h"
#include "bench/options.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::exec::debugger {

struct DebuggerOptions {
    ExecOptions exec;                  ///< image, board, scripts at the UARTs, stimulus
    std::vector<std::string> sources;  ///< folders with source files, before the image's and this one
};

/// What goes without saying for the board or chip: which board the image is for, crystal, rates. Throws
/// InputError.
void complete_options(DebuggerOptions& options);

/// What stops the program, by its number.
struct Point {
    enum class Kind : std::uint8_t { Break, Watch, Bits };
    Kind kind = Kind::Break;
    std::string text;                   ///< as the user wrote it
    std::vector<std::uint32_t> places;  ///< program addresses, of Break
    debug::Watchpoint watch{};
    debug::BitWatch bits{};
    bool once = false;
    std::size_t hits = 0;
};

class Session {
  public:
    /// Throws InputError for an image, script or stimulus that cannot be used.
    explicit Session(const DebuggerOptions& options);
    ~Session();

    Debugged& debugged() { return *debugged_; }
    debug::DebugChip& chip() { return debugged_->chip(); }
    const Program& program() const { return *program_; }
    Motion& motion() { return *motion_; }

    /// PLACE as Program::addresses() has it, or a register's field or bit, perhaps =VALUE: stops when it
    /// changes, or becomes that. Throws InputError.
    int add_break(const std::string& text, const std::string& current_file, bool once);
    /// Stops after an instruction that writes (`w`), reads (`r`) or does either (`rw`) there. Throws
    /// InputError.
    int add_watch(const std::string& text, const std::string& kind);
    bool remove(int number);
    const std::map<int, Point>& points() const { return points_; }
    /// Numbers of those that made the program stop here; one that stops once is removed.
    std::vector<int> hit(const debug::Stop& stop);

    /// The run is over, or was never begun: nothing moves any more.
    bool over() const { return over_; }
    void end() { over_ = true; }
    /// It went back from its end.
    void revive() { over_ = false; }
    /// What the bench reports when it is over.
    std::string summary() { return debugged_->summary(); }
    void finish();

  private:
    std::unique_ptr<Bench> bench_;
    std::unique_ptr<Debugged> debugged_;
    std::unique_ptr<Program> program_;
    std::unique_ptr<Motion> motion_;
    std::map<int, Point> points_;
    int next_ = 1;
    bool over_ = false;
};

}  // namespace puckloop::exec::debugger
