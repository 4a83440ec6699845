#pragma once
// The bus master that plays an `--i2c` script against a target that is a slave. A line's time is that of its
// START: the first clock of the address byte falls at `time`, or two clocks after the STOP of the line before
// it (STOP and START take one each). A byte takes nine clocks and what the slave stretches them; a STOP and a
// repeated START take one. The master never gives up on a byte that is not acknowledged: it sends STOP and
// goes on with the next line. A raw line does what it states, whatever the slave answers; the bytes that it
// reads are reported with the address byte before them. A STOP or START that the first bit of a slave's next
// byte prevents comes behind nine clocks with SDA let go, as drivers free a bus.
//
// Deviations: nobody else is on the bus, and SCL low for 100 ms counts as stuck (SMBus states 25 to 35 ms,
// Linux drivers wait up to a second; the firmware known here holds it for 2 ms). The script then ends.

#include "bench/logs.h"
#include "bench/targets/target.h"
#include "ends/scripts.h"

#include <optional>
#include <string>
#include <vector>

namespace puckloop::exec {

struct I2cMasterOptions {
    double clock_hertz = 100e3;
    bool repeated_start = true;  ///< a read names its register and goes on without STOP
};

struct I2cScriptReport {
    struct Read {
        cosim::Time time = 0;  ///< of its first START
        std::uint16_t address = 0;
        std::optional<std::uint8_t> register_number;
        std::vector<std::uint8_t> bytes;
    };
    std::size_t lines = 0, played = 0;
    std::uint64_t starts = 0, bytes_written = 0, bytes_read = 0;
    std::uint64_t addresses_refused = 0, bytes_refused = 0;
    int first_refused = 0;  ///< line in the file; 0: none
    cosim::Time stretched = 0, longest_stretch = 0;
    cosim::Time last_stop = 0;  ///< when the bus was free again after the last line
    std::vector<Read> reads;    ///< the first 1000 that returned a byte
    std::optional<cosim::Time> stuck_since;
    int stuck_line = 0;
};

class I2cScriptMaster {
  public:
    /// `logs` may be null; `script` is sorted by time.
    I2cScriptMaster(std::vector<I2cScriptLine> script, const I2cMasterOptions& options, Target& target,
                    Logs* logs);

    /// When the next phase begins: the moment to call begin(). kNever while the slave is thinking.
    cosim::Time due() const;
    /// How far the target may be run before due() has to be asked again.
    cosim::Time limit() const;
    void begin();
    /// The slave's answer to the last phase, `now` on the wire.
    void answered(const cosim::I2cPhase& answer, cosim::Time now);
    /// From time to time: is the bus stuck?
    void poll(cosim::Time now);

    const I2cScriptReport& report() const { return report_; }

    static constexpr cosim::Time kStuckAfter = 100 * cosim::kMillisecond;

  private:
    struct Step {
        cosim::I2cPhaseKind kind = cosim::I2cPhaseKind::Stop;
        std::uint8_t byte = 0;
        std::uint8_t ack = 0;
        int clocks = 9;      ///< fewer: the next step breaks it off
        bool frees = false;  ///< clocks that free SDA, no byte of the script's
    };
    void plan();
    void plan_raw(const std::vector<I2cRawStep>& raw);
    void ask_first_bit();
    void first_bit_known(bool low, cosim::Time now);
    void next_line();
    void refused(const cosim::I2cPhase& phase);

    std::vector<I2cScriptLine> script_;
    cosim::Time clock_;
    bool repeated_start_;
    Target& target_;
    Logs* logs_;
    std::size_t line_ = 0;
    std::vector<Step> steps_;  // of the present line
    std::size_t step_ = 0;
    cosim::Time next_ = cosim::kNever;  // when the step begins
    std::optional<cosim::I2cPhase> open_;
    bool reading_ = false;         // this line's read has begun to return bytes
    std::uint16_t addressed_ = 0;  // by the newest address byte
    bool raw_ = false;             // this line goes on whatever is answered
    bool sends_ = false;           // the slave has a byte to send next
    I2cScriptReport report_;
};

}  // namespace puckloop::exec
