#pragma once
// The log of a board, as far as its dsPIC goes: firmware, resets, traps, registers without a model, warnings,
// UART firsts and errors. The board adds lines of its own.
//
// The chip is asked at fixed multiples of simulated time, and the lines of one such stretch are sorted by
// time and text: the log does not depend on how grants were cut.

#include "base/node_log.h"
#include "cosim/core/message.h"
#include "cosim/core/time.h"
#include "emu/dspic/chip/chip.h"
#include "emu/image/symbol_table.h"

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::board {

class ChipLog {
  public:
    /// An empty path is no log. Throws RunError as NodeLog does.
    ChipLog(const std::string& path, const image::Image& image);

    bool is_open() const { return log_.is_open(); }
    /// The next time at which look() wants to be called, with the chip run up to it; kNever without a log.
    cosim::Time next_look() const { return is_open() ? next_look_ : cosim::kNever; }
    void look(const dspic::Chip& chip);
    /// The last look and the summary, to which `board` is added.
    void end(cosim::Time now, const dspic::Chip& chip, const std::string& board);

    /// A line of the board's; `time` lies in the stretch that the next look ends.
    void note(cosim::Time time, std::string text);
    /// Both at the stop bit.
    void sent(int unit, const cosim::UartFrame& frame, cosim::Time now);
    void arrived(int unit, const cosim::UartFrame& frame, cosim::Time now, bool listening);

    /// What was written so far is part of it; a log that loads it writes it again.
    template <class Archive>
    void state(Archive& archive) {
        archive.apart(lines_);
        archive.grows(history_);
        archive(resets_, traps_, unmodelled_, warnings_, uarts_);
        archive.bounded(next_look_, 0, cosim::kNever);
        archive.bounded(written_, 0, cosim::kNever);
    }
    /// After a state was loaded that was saved at `now`.
    void loaded(cosim::Time now);

    /// From here on lines are kept back, until settle() puts them into the file, or rewind(), called before a
    /// checkpoint is read, takes back what was noted since the mark, which stays. settle() throws as line().
    void mark();
    void rewind();
    void settle();

  private:
    static constexpr std::size_t kUarts = 2;
    struct UartSeen {
        bool sent = false, arrived = false;
        dspic::UartCounters counters;  // errors told so far
        template <class Archive>
        void state(Archive& archive) {
            archive(sent, arrived, counters);
        }
    };
    void read_report(cosim::Time now, const dspic::Chip& chip);
    void read_errors(cosim::Time now, const dspic::Chip& chip);
    void write_until(cosim::Time now);
    std::string place(std::uint32_t pc) const;

    using Line = std::pair<cosim::Time, std::string>;
    NodeLog log_;
    image::CodeSymbols symbols_;
    std::vector<Line> lines_;    // not yet written
    std::vector<Line> history_;  // written, the firmware's line left out
    bool marked_ = false;
    std::size_t lines_at_mark_ = 0;
    std::optional<std::vector<Line>> kept_;  // lines_ at the mark, once a look has taken some of them
    cosim::Time next_look_;
    cosim::Time written_ = 0;  // all before this is in the file
    std::size_t resets_ = 0, traps_ = 0, unmodelled_ = 0, warnings_ = 0;
    std::array<UartSeen, kUarts> uarts_;
};

}  // namespace puckloop::board
