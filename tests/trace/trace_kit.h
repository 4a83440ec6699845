#pragma once
// What the tests of exported traces share: traces drawn at random, programs started, and what a trace holds
// by the plainest reading of its rows.

#include "cosim/trace/trace_row.h"

#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace puckloop::tests {

struct Called {
    int status = -1;
    std::string out;  ///< standard output; of puckloop() standard error as well
};

/// In a shell; standard error goes to the test's own.
Called shell(const std::string& command);
Called puckloop(const std::string& arguments);

/// True if the program is installed; prints it on standard error if not.
bool installed(const std::string& program);

std::vector<std::string> lines_of(const std::string& text);

/// A file of its own for this process.
std::string scratch(const std::string& name);
std::string write_trace(const std::string& name, const std::vector<cosim::TraceRow>& rows);
std::vector<cosim::TraceRow> rows_of(const std::string& file);

cosim::TraceRow uart_row(const std::string& link, const std::string& from, const cosim::UartFrame& frame,
                         cosim::FaultKind fault = cosim::FaultKind::None);

/// Writes I2C rows as master and bus make them: appends to `rows`, in their order.
class I2cScript {
  public:
    I2cScript(std::vector<cosim::TraceRow>& rows, cosim::Time period) : rows_(rows), period_(period) {}
    void start(std::uint8_t byte, bool acknowledged, cosim::Time stretch);
    void write(std::uint8_t byte, bool acknowledged, cosim::Time stretch);
    void read(std::uint8_t byte, bool acknowledged, cosim::Time stretch);
    void stop();
    void pause(cosim::Time time) { now_ += time; }
    cosim::Time now() const { return now_; }

  private:
    void row(const std::string& from, cosim::I2cPhase phase);
    void answer(cosim::I2cPhaseKind kind, std::uint8_t byte, bool acknowledged, cosim::Time stretch);

    std::vector<cosim::TraceRow>& rows_;
    cosim::Time period_, now_ = cosim::kMillisecond, start_ = 0;
    std::vector<cosim::TraceRow> late_;  // the answer: its row comes behind the next request's
};

/// What the wires show, in words: "S" (repeated or not), "a20" the address, "W40", "R07", "A", "N", "P".
std::vector<std::string> i2c_words(const std::vector<cosim::TraceRow>& rows, const std::string& link);

}  // namespace puckloop::tests
