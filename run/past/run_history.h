#pragma once
// The past of a run that can go back, under a debugger or a client: snapshots of the whole run in memory, so
// that any instant so far can be had again from the one before it (docs/debugging.md).
//
// What links have carried is kept once for all of them: the record at one snapshot is the beginning of the
// record at any later one.

#include "cosim/resume/run_snapshot.h"
#include "cosim/trace/trace_csv.h"
#include "run/description/run_request.h"
#include "run/description/run_setup.h"
#include "run/expectations/line_watch.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

/// Why a run cannot go back; empty: it can.
std::string why_not_back(const RunSetup& setup, const RunRequest& request);

class RunHistory {
  public:
    /// A board under a debugger, where a snapshot was taken.
    struct Board {
        std::uint64_t cycle = 0;  ///< at which its next instruction begins
        std::size_t changes = 0;  ///< so many of the debugger's changes had been made
    };
    /// What goes with the run itself.
    struct Place {
        std::vector<Board> boards;
        std::uint64_t trace = 0;                ///< bytes of trace.csv
        std::uint64_t record = 0;               ///< bytes of record.csv, where there is one
        std::vector<LineWatch::Watch> lines{};  ///< what expectations had seen of serial lines
    };

    /// The run begins from `origin`, null for power-up, before which there is nothing.
    void begin(std::shared_ptr<const cosim::RunSnapshot> origin, Place place);
    bool begun() const { return !instants_.empty(); }

    /// When the next snapshot after `time` is due; none while the run repeats its past.
    cosim::Time next(cosim::Time time) const;
    /// Keeps what the conductor saved.
    void take(cosim::RunSnapshot& snapshot, Place place);

    std::size_t count() const { return instants_.size(); }
    const Place& place(std::size_t instant) const { return instants_[instant].place; }
    /// The latest instant before which `board` had not begun the instruction at `cycle`; nothing: none.
    std::optional<std::size_t> before(std::size_t board, std::uint64_t cycle) const;
    /// The latest instant that is not after `time`; the first if there is none.
    std::size_t at_or_before(cosim::Time time) const;
    cosim::Time time(std::size_t instant) const;
    /// What comes after `instant` will be another run: its snapshots go.
    void forget_after(std::size_t instant);
    /// The snapshot to begin from, null for power-up.
    std::shared_ptr<const cosim::RunSnapshot> snapshot(std::size_t instant) const;

    /// Between two snapshots; doubled whenever there are kMost of them, and every other one goes.
    static constexpr cosim::Time kFirstInterval = 100 * cosim::kMillisecond;
    static constexpr std::size_t kMost = 32;

  private:
    struct Instant {
        Place place;
        std::shared_ptr<const cosim::RunSnapshot> snapshot;  ///< its wires without what they carried
        std::vector<cosim::SentRecord::Length> sent;         ///< by each wire
    };
    void thin_out();

    std::vector<Instant> instants_;
    std::vector<cosim::WireState> carried_;  ///< by the wires up to the last snapshot
    cosim::Time last_ = 0;                   ///< of all snapshots ever taken
    cosim::Time interval_ = kFirstInterval;
};

/// What a run writes and looks for while it goes; must stay.
struct RunWritten {
    std::optional<cosim::TraceCsvSink>& trace;
    std::optional<cosim::TraceCsvSink>& record;
    const LineWatch& lines;

    /// How far all of it is now.
    RunHistory::Place place(std::vector<RunHistory::Board> boards = {}) const;
};

}  // namespace puckloop::tools
