#pragma once
// Looks at the board's I2C slave, phase by phase, and keeps count: for the log and the report, it changes
// nothing. The register map is the e-RandB's (range-and-bearing fact sheet 2.1); what silicon and firmware
// ignore without a word (a payload size of 7, a register that does not exist) is reported here.

#include "cosim/core/message.h"
#include "cosim/core/message_state.h"
#include "cosim/core/time.h"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace puckloop::rab {

struct I2cCounters {
    std::uint64_t transfers = 0;  ///< Starts for the board, repeated ones included
    std::uint64_t bytes_written = 0, bytes_read = 0;
    std::uint64_t not_acknowledged = 0;  ///< Starts and bytes
    std::uint64_t long_stretches = 0;    ///< longer than kLongStretch
    cosim::Time stretched = 0, longest_stretch = 0;
    std::uint64_t sends = 0;        ///< values written to registers 14 and 15
    std::uint64_t messages = 0;     ///< reads of register 0 that said 1
    std::uint64_t empty_polls = 0;  ///< reads of register 0 that said 0
    std::uint64_t bad_sizes = 0, read_only_writes = 0, unknown_writes = 0, unknown_reads = 0;

    template <class Archive>
    void state(Archive& archive) {
        archive(transfers, bytes_written, bytes_read, not_acknowledged, long_stretches, stretched,
                longest_stretch, sends, messages, empty_polls, bad_sizes, read_only_writes, unknown_writes,
                unknown_reads);
    }
};

class I2cWatch {
  public:
    using LogLine = std::function<void(cosim::Time, std::string)>;
    /// `log_line` gets a line for the log, with its time.
    explicit I2cWatch(LogLine log_line) : log_line_(std::move(log_line)) {}

    /// The firmware's 7-bit address. Starts for others are not counted unless they are acknowledged.
    static constexpr std::uint8_t kAddress = 0x20;

    /// What the master began, and what the chip answered, `now` on the wire.
    void phase(const cosim::I2cPhase& phase, cosim::Time now);
    void answer(const cosim::I2cPhase& answer, cosim::Time now);

    const I2cCounters& counters() const { return counters_; }

    static constexpr cosim::Time kLongStretch = 300 * cosim::kMicrosecond;

    template <class Archive>
    void state(Archive& archive) {
        archive(counters_, open_, register_, awaiting_register_, sizes_, unknown_writes_, read_only_writes_,
                unknown_reads_);
        archive.bounded(read_index_, 0, 1 << 30);
    }

  private:
    void stretched(cosim::Time by, cosim::Time now);
    void written(std::uint8_t value, cosim::Time now);
    void read(std::uint8_t value, cosim::Time now);
    void count(std::uint64_t& counter, cosim::Time now, const std::string& text);
    std::string place() const;

    LogLine log_line_;
    I2cCounters counters_;
    cosim::I2cPhase open_;                  // the phase that waits for its answer
    std::optional<std::uint8_t> register_;  // written last; it stays from one transfer to the next
    bool awaiting_register_ = false;
    int read_index_ = 0;  // bytes read since the register was written
    std::uint64_t sizes_ = 0;
    std::array<std::uint64_t, 256> unknown_writes_{}, read_only_writes_{}, unknown_reads_{};
};

}  // namespace puckloop::rab
