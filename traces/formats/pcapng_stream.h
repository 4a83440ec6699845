#pragma once
// The pcapng form of a trace (export.h) while its rows come.

#include "cosim/trace/trace_row.h"
#include "traces/fault_marks.h"

#include <memory>
#include <ostream>

namespace puckloop::tools {

class PcapngStream {
  public:
    /// Writes the file's header.
    /// `marks`, which must outlive it, are known once the run has ended.
    explicit PcapngStream(std::ostream& out, const FaultMarks* marks = nullptr);
    ~PcapngStream();
    PcapngStream(const PcapngStream&) = delete;
    PcapngStream& operator=(const PcapngStream&) = delete;

    /// In the order of the trace. Packets that are complete by now are written.
    void add(const cosim::TraceRow& row);
    /// The rest.
    void end();

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace puckloop::tools
