#pragma once
// The lines of a board's log, which is the same however grants were cut: the board is looked at at fixed
// multiples of simulated time, and the lines of one such stretch are sorted by time and text.

#include "base/logs/node_log.h"
#include "cosim/core/time.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::board {

class TimedLines {
  public:
    /// An empty path is no log. Throws RunError as NodeLog does.
    explicit TimedLines(const std::string& path);

    bool is_open() const { return log_.is_open(); }
    /// The next time at which the board wants to be looked at, run up to it; kNever without a log.
    cosim::Time next_look() const { return is_open() ? next_look_ : cosim::kNever; }
    /// The look of now has begun; the lines that it finds lie between written() and it.
    cosim::Time begin_look();
    /// All before this is in the file.
    cosim::Time written() const { return written_; }
    /// The look is done: what lies before `now` goes into the file.
    void write_until(cosim::Time now);

    /// `time` lies in the stretch that the next look ends. Nothing happens without a log.
    void note(cosim::Time time, std::string text);
    /// Straight into the file: its first lines, and its last behind write_until(kNever).
    void line(cosim::Time time, const std::string& text) { log_.line(cosim::to_seconds(time), text); }

    /// What was written so far is part of it; a log that loads it writes it again.
    template <class Archive>
    void state(Archive& archive) {
        archive.apart(lines_);
        archive.grows(history_);
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
    using Line = std::pair<cosim::Time, std::string>;
    NodeLog log_;
    std::vector<Line> lines_;    // not yet written
    std::vector<Line> history_;  // written; first and last lines left out
    bool marked_ = false;
    std::size_t lines_at_mark_ = 0;
    std::optional<std::vector<Line>> kept_;  // lines_ at the mark, once a look has taken some of them
    cosim::Time next_look_;
    cosim::Time written_ = 0;
};

}  // namespace puckloop::board
