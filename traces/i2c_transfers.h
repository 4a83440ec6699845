#pragma once
// Phases of one I2C master put together with the answers to them: what was on the wires, byte by byte.
//
// A row of the trace is a phase of the master or an answer of the bus. An answer repeats the start of the
// byte that it ends (later than the master's where another transfer was waited for); the master's next phase,
// begun at the same time, has its row before it. Links between the bus and devices that are boards of their
// own show the same bytes again: they are recognised by who sends Acknowledge, and left out.

#include "cosim/trace/trace_row.h"

#include <deque>
#include <functional>
#include <map>
#include <string>

namespace puckloop::tools {

/// What one phase of a master became.
struct I2cStep {
    enum class Kind : std::uint8_t { Start, Write, Read, Stop };
    enum class End : std::uint8_t {
        Answered,
        Lost,      ///< another master has the bus, or it is stuck: not on the wires
        Abandoned  ///< no answer came before the master went on, or the trace ended
    };
    Kind kind = Kind::Stop;
    End end = End::Answered;
    std::uint8_t byte = 0;      ///< address byte, data written or read; 0 for Stop and a Read without answer
    bool acknowledged = false;  ///< the ninth bit was low
    cosim::Time start = 0, clock_period = 0, stretch = 0;
    cosim::Time known = 0;  ///< time of the row that completed it
    cosim::FaultKind fault = cosim::FaultKind::None;
    std::string master;  ///< node
    std::string bus;     ///< node; empty while it has answered nothing
    std::string link;
};

/// One of these takes all I2C rows of a trace.
class I2cTransfers {
  public:
    using Take = std::function<void(const I2cStep&)>;
    explicit I2cTransfers(Take take) : take_(std::move(take)) {}

    void add(const cosim::TraceRow& row, const cosim::I2cPhase& phase);
    /// The trace ends: steps without an answer are handed over as Abandoned.
    void end();

  private:
    struct Link {
        std::string master, bus;
        bool device = false;  ///< the bus asks here
        std::deque<I2cStep> open;
        cosim::Time requested = 0;  ///< time of the newest request
    };
    void request(Link& link, const cosim::TraceRow& row, const cosim::I2cPhase& phase);
    void answer(Link& link, const cosim::TraceRow& row, const cosim::I2cPhase& phase);
    void hand_over(Link& link, I2cStep::End end);

    Take take_;
    std::map<std::string, Link> links_;
};

}  // namespace puckloop::tools
