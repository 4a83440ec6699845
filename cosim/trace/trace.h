#pragma once
// The trace: every message on every link, in the order of (time, link, direction, sequence), the same in
// every placement. Sinks take it in that order.

#include "cosim/core/link.h"
#include "cosim/core/message.h"
#include "cosim/core/time.h"
#include "cosim/faults/spec/fault_kind.h"

#include <cstdint>
#include <tuple>
#include <vector>

namespace puckloop::cosim {

struct TraceRecord {
    Time time = 0;  ///< of delivery
    std::uint16_t link = 0;
    Direction direction = Direction::FromA;
    std::uint64_t sequence = 0;  ///< counts the messages of one direction of one link
    FaultKind fault = FaultKind::None;
    Payload payload;

    auto key() const { return std::tuple(time, link, direction, sequence); }
    friend bool operator==(const TraceRecord&, const TraceRecord&) = default;
};

/// True where a fault kept the message from arriving.
inline bool lost(const TraceRecord& record) {
    return keeps_from_arriving(record.fault);
}

/// Where a trace goes. Calls may throw RunError (a full disk); what was written before stays.
class TraceSink {
  public:
    virtual ~TraceSink() = default;
    virtual void begin(const std::vector<LinkSpec>& links) = 0;
    virtual void record(const TraceRecord& record) = 0;
    /// Everything recorded so far is on disk afterwards.
    virtual void flush() {}
};

}  // namespace puckloop::cosim
