#pragma once
// A range-and-bearing board's firmware on the bench: a master on its I2C bus, light on its sensors, its
// emitters read back as chips. All is planned first, then run once.

#include "tests/exec/rig.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::firmware {

inline constexpr double kChip = 98.1e-6;  ///< s
using Levels = std::array<int, 12>;       ///< A/D counts at the peak detectors while light is on; 0: unlit

/// Light with these peaks on these sensors (index 0..11), none on the others.
Levels levels(std::initializer_list<std::pair<int, int>> peaks);

struct Light {
    double chip = kChip;
    double on_delay = 8e-6;  ///< of the demodulator
    double off_delay = 8e-6;
};

struct SentFrame {
    double start = 0;
    double chip = 0;    ///< mean length, s; from the frame's edges
    double jitter = 0;  ///< of its edges, s
    std::string chips;
};

/// Chips without the dark ones at the end, which no edge shows.
std::string lit_part(std::string chips);

class RabBench {
  public:
    explicit RabBench(const std::string& image) : rig("rab", image) {}

    /// Bytes after the address; the first is the register.
    void write(double time, std::vector<std::uint8_t> bytes);
    /// One read transaction; the result is reads()[n] for the n-th call in the order of time.
    void read(double time, int number, int count = 1);
    /// The whole message: reads 0 and 1..11 one by one; see message().
    double poll(double time);
    /// Light by a text of chips, '1' on; returns its end.
    double light(double time, const std::string& chips, const Levels& peaks, const Light& light = {});
    void signal(double time, const std::string& name, double value);
    void run(double until);

    const std::vector<std::vector<std::uint8_t>>& reads() const { return reads_; }
    const exec::I2cScriptReport& bus() { return rig.bench().master()->report(); }
    /// What emitter 1..12 sent.
    std::vector<SentFrame> sent(int emitter) const;

    exec::Rig rig;
    exec::I2cMasterOptions master;

  private:
    std::vector<exec::I2cScriptLine> script_;
    std::vector<exec::StimulusLine> stimulus_;
    std::vector<std::vector<std::uint8_t>> reads_;
};

/// A message as poll() reads it.
struct Message {
    bool there = false;
    std::uint32_t data = 0;
    int bearing = 0, range = 0, peak = 0, sensor = 0;
};
/// The poll whose first read is reads()[first]; it takes kPollReads of them.
inline constexpr std::size_t kPollReads = 12;
Message message(const RabBench& bench, std::size_t first);

}  // namespace puckloop::firmware
