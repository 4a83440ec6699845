#pragma once
// The bench: a target, its two UART lines, a stimulus, recordings, and the clock on the wall if somebody live
// is at an end.

#include "bench/i2c_script_master.h"
#include "bench/logs.h"
#include "bench/targets/target.h"
#include "bench/uart_line.h"
#include "bench/wav_file.h"
#include "ends/scripts.h"

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::exec {

class History;

struct BenchOptions {
    std::string mcu;  ///< one of these two
    std::string board;
    TargetOptions target;
    std::array<double, 2> baud{115200, 115200};  ///< of the bench's ends
    std::string log_folder;                      ///< empty: no recordings
    bool record = false;                         ///< keep a history, so that the target can be had as it was
};

class Bench : private TargetListener {
  public:
    explicit Bench(const BenchOptions& options);

    Target& target() { return *target_; }
    /// The target as History; null unless it keeps one.
    History* history() { return history_; }
    dspic::Chip& chip() { return target_->chip(); }
    UartLine& uart(int unit) { return lines_[static_cast<std::size_t>(unit - 1)]; }
    /// Plays a script on the bus of a target that is a slave.
    void master(std::vector<I2cScriptLine> script, const I2cMasterOptions& options);
    /// Null without a script.
    const I2cScriptMaster* master() const { return master_ ? &*master_ : nullptr; }
    /// Adds to what is still to come; values take effect at the first instruction at or after their time.
    void stimulate(const std::vector<StimulusLine>& stimulus);
    /// A pulse on the chip's MCLR now.
    void press_reset();
    /// From now on simulated time does not run ahead of the wall clock. Where it falls behind by more than 50
    /// ms (the machine is busy, or was suspended) the rest is given up: fallen_behind().
    void pace_by_wall_clock();
    cosim::Time fallen_behind() const { return fallen_behind_; }
    /// Called once a simulated millisecond; true ends run_until().
    std::function<bool()> interrupted;
    /// Called for every pin and signal change that is also logged.
    std::function<void(std::string_view pin, std::string_view signal, double value, cosim::Time time)>
        on_change;

    enum class End { Time, Address, Interrupted };
    /// Runs everything before `until`.
    End run_until(cosim::Time until);
    cosim::Time now() const { return now_; }
    /// Writes out what is still on its way to files and ends.
    void finish();

  private:
    std::unique_ptr<Target> make(const BenchOptions& options);
    void uart_sent(int unit, const cosim::UartFrame& frame) override;
    void i2c_phase(int unit, const cosim::I2cPhase& phase) override;
    void i2c_answered(const cosim::I2cPhase& answer, cosim::Time time) override;
    void pin_changed(std::string_view pin, std::string_view function, std::optional<bool> level,
                     cosim::Time time) override;
    void signal_changed(std::string_view name, double value, cosim::Time time) override;
    void sound_sample(double value, cosim::Time time) override;
    void apply_stimulus();
    void poll();
    void wait_for_wall_clock();

    std::unique_ptr<Logs> logs_;
    std::optional<WavFile> speaker_;  ///< with recordings
    History* history_ = nullptr;
    std::unique_ptr<Target> target_;
    std::array<UartLine, 2> lines_;
    std::optional<I2cScriptMaster> master_;
    std::vector<StimulusLine> stimulus_;
    std::size_t next_stimulus_ = 0;
    cosim::Time now_ = 0;
    cosim::Time next_poll_ = 0;
    bool paced_ = false;
    std::int64_t wall_origin_ns_ = 0;
    cosim::Time fallen_behind_ = 0;
};

}  // namespace puckloop::exec
