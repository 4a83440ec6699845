#pragma once
// The log of a board, as far as its dsPIC goes: firmware, resets, traps, registers without a model, warnings,
// UART firsts and errors. The board adds lines of its own (timed_lines.h states when).

#include "cosim/core/message.h"
#include "cosim/core/time.h"
#include "emu/board/timed_lines.h"
#include "emu/dspic/chip/chip.h"
#include "emu/image/symbol_table.h"

#include <array>
#include <string>

namespace puckloop::board {

class ChipLog {
  public:
    /// An empty path is no log. Throws RunError as NodeLog does.
    ChipLog(const std::string& path, const image::Image& image);

    bool is_open() const { return lines_.is_open(); }
    /// The next time at which look() wants to be called, with the chip run up to it; kNever without a log.
    cosim::Time next_look() const { return lines_.next_look(); }
    void look(const dspic::Chip& chip);
    /// The last look and the summary, to which `board` is added.
    void end(cosim::Time now, const dspic::Chip& chip, const std::string& board);

    /// A line of the board's; `time` lies in the stretch that the next look ends.
    void note(cosim::Time time, std::string text) { lines_.note(time, std::move(text)); }
    /// Both at the stop bit.
    void sent(int unit, const cosim::UartFrame& frame, cosim::Time now);
    void arrived(int unit, const cosim::UartFrame& frame, cosim::Time now, bool listening);

    /// What was written so far is part of it; a log that loads it writes it again.
    template <class Archive>
    void state(Archive& archive) {
        archive(lines_, resets_, traps_, unmodelled_, warnings_, uarts_);
    }
    /// As TimedLines.
    void loaded(cosim::Time now) { lines_.loaded(now); }
    void mark() { lines_.mark(); }
    void rewind() { lines_.rewind(); }
    void settle() { lines_.settle(); }

  private:
    static constexpr std::size_t kUarts = 2;
    struct UartSeen {
        bool sent = false, arrived = false;
        dspic::UartCounters counters;  // errors reported so far
        template <class Archive>
        void state(Archive& archive) {
            archive(sent, arrived, counters);
        }
    };
    void read_report(cosim::Time now, const dspic::Chip& chip);
    void read_errors(cosim::Time now, const dspic::Chip& chip);
    std::string place(std::uint32_t pc) const;

    TimedLines lines_;
    image::CodeSymbols symbols_;
    std::size_t resets_ = 0, traps_ = 0, unmodelled_ = 0, warnings_ = 0;
    std::array<UartSeen, kUarts> uarts_;
};

}  // namespace puckloop::board
