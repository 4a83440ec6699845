#pragma once
// A real image of the range-and-bearing board on the bench, for tests: a bus master that is spoken to call by
// call, frames shown to the receivers, chips read off the emitters.

#include "tests/exec/rig.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::rab {

/// The chip of the fact sheet, s.
inline constexpr double kChip = 98.085e-6;
/// Both real images; they hold the same program.
inline constexpr const char* kRandb = "randb.hex";
inline constexpr const char* kErab = "erab_1to4b.hex";

/// What a sensor (index 0..11) sees of a frame: peak above its baseline.
struct Seen {
    int sensor = 0;
    int peak = 0;
};

/// Chips as they stood at one emitter.
struct Burst {
    std::string chips;   ///< without the off chips at its end
    double start_s = 0;  ///< first edge
    double chip_s = 0;   ///< mean of the chips up to the last edge
    double last_edge_s = 0;
};

class RabRig {
  public:
    explicit RabRig(const std::string& image_file, double i2c_hertz = 100e3);

    exec::Rig& bench() { return rig_; }
    dspic::Chip& chip() { return rig_.chip(); }
    double now_s() const { return rig_.now_s(); }
    void run_for(double seconds) { rig_.run_for(seconds); }
    void run_to(double time_s) { rig_.run_to(time_s); }
    /// Ambient level at all twelve detectors: the baseline if set before boot().
    void ambient(int counts);
    /// Runs until the main loop is reached (with margin); forgets what was printed and changed so far.
    void boot();

    /// One transfer, now; returns when it is over.
    const exec::I2cScriptReport& write(int number, const std::vector<std::uint8_t>& bytes);
    std::vector<std::uint8_t> read(int number, int count = 1);
    /// Reads on without naming a register.
    std::vector<std::uint8_t> read_on(int count);
    int get(int number) { return read(number).at(0); }
    int get16(int number) { return get(number) << 8 | get(number + 1); }
    /// Lines of a script, "<time_s> w ...", while time goes on.
    void play(const std::string& script);
    const exec::I2cScriptReport& bus() { return rig_.bench().master()->report(); }
    /// Sends `payload` on all emitters, as the hosts do: high bytes to 13, 19 and 20, the last one to 14.
    void send(int size, std::uint32_t payload);

    /// From `time_s` on these sensors see the chips; their detectors' inputs rise with them. The
    /// demodulators need `on_s` to come on and `off_s` to go off.
    void show(double time_s, const std::string& chips, const std::vector<Seen>& sensors,
              double chip_s = kChip, double on_s = 8e-6, double off_s = 8e-6);
    /// A signal that takes a value later.
    void later(double time_s, const std::string& signal, double value);

    /// What emitter 1..12 sent since the last clear(): pieces with at least three off chips between them.
    std::vector<Burst> bursts(int emitter = 1) const;
    const std::vector<exec::Rig::Change> changes(const std::string& name) const { return rig_.changes(name); }
    void clear() { rig_.clear_changes(); }

    /// Result registers after a poll that found a message.
    struct Message {
        std::uint32_t data = 0;
        int bearing = 0;
        int range = 0;
        int peak = 0;
        int sensor = 0;
    };
    /// Polls once; nothing if no message waits.
    std::optional<Message> poll();

  private:
    void finish_script();

    exec::Rig rig_;
    exec::I2cMasterOptions master_;
    int ambient_ = 0;
};

/// Chips without the off chips at the end: what an emitter can show of them.
std::string visible(std::string chips);

}  // namespace puckloop::rab
