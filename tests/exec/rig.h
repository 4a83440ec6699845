#pragma once
// A real image on the bench, for tests: bytes in and out with their times, signal changes, registers.

#include "bench/bench.h"
#include "ends/script_end.h"

#include <optional>
#include <string>
#include <vector>

namespace puckloop::exec {

/// Path of a real image, from the folder that PUCKLOOP_IMAGES names; warns and gives nothing if it is not
/// there.
std::optional<std::string> real_image(const std::string& name);

class Rig {
  public:
    struct Change {
        std::string name;  ///< signal, or pin where it has no function
        double value;
        double time_s;
    };

    /// `where` is "pic" or "rab" (a board) or a chip's name (bare).
    /// `revision` is of the main board; 1.3 has its LSM330 on the bus. `uart2_baud`: of the bench's
    /// end, 0 is the board's usual one.
    Rig(const std::string& where, const std::string& image_file,
        pic::Revision revision = pic::Revision::Rev12, double uart2_baud = 0.0);

    Bench& bench() { return *bench_; }
    dspic::Chip& chip() { return bench_->chip(); }
    double now_s() const { return cosim::to_seconds(bench_->now()); }
    void run_to(double time_s) { bench_->run_until(cosim::from_seconds(time_s)); }
    void run_for(double seconds) { run_to(now_s() + seconds); }
    void set(const std::string& signal, double value);
    double get(const std::string& signal);

    /// Bytes begun now, back to back. Returns when the last stop bit will end, in seconds.
    double send(int unit, const std::vector<std::uint8_t>& bytes);
    /// Everything received since the last call.
    std::vector<ScriptEnd::Heard> take(int unit);
    std::vector<std::uint8_t> take_bytes(int unit);
    std::string take_text(int unit);

    /// Changes since the last call of clear_changes(), of one signal or pin.
    std::vector<Change> changes(const std::string& name) const;
    const std::vector<Change>& changes() const { return changes_; }
    void clear_changes() { changes_.clear(); }

  private:
    std::unique_ptr<Bench> bench_;
    double baud_ = 0;
    std::array<ScriptEnd*, 2> ends_{};
    std::array<std::size_t, 2> taken_{};
    std::vector<Change> changes_;
};

}  // namespace puckloop::exec
