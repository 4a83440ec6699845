#include "traces/rab_losses/board_bus.h"

namespace puckloop::tools {

using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::Time;

namespace {
// Shorter services of the bus do not move a sample or a chip that matters.
constexpr Time kShortest = 10 * cosim::kMicrosecond;
}  // namespace

void BoardBus::add(const cosim::TraceRow& row) {
    const auto* phase = std::get_if<I2cPhase>(&row.payload);
    if (phase == nullptr) return;
    switch (phase->kind) {
    case I2cPhaseKind::Start:
    case I2cPhaseKind::Write:
    case I2cPhaseKind::Read:
        asked_ = *phase;
        break;
    case I2cPhaseKind::Stop:
        addressed_ = false;
        break;
    case I2cPhaseKind::Acknowledge:
    case I2cPhaseKind::Data:
        answered(*phase, row.time);
        break;
    case I2cPhaseKind::BusLost:
        break;
    }
}

void BoardBus::answered(const I2cPhase& answer, Time now) {
    const bool acknowledged = answer.kind == I2cPhaseKind::Acknowledge && answer.ack != 0;
    if (asked_.kind == I2cPhaseKind::Start) {
        addressed_ = acknowledged;
        pointer_next_ = true;
    }
    if (!addressed_) return;
    Time begin = now - answer.stretch;
    if (asked_.kind == I2cPhaseKind::Read) {
        begin = asked_.start;
        accesses_.push_back({now, true, pointer_, answer.byte});
    } else if (asked_.kind == I2cPhaseKind::Write && pointer_next_) {
        pointer_ = asked_.byte;
        pointer_next_ = false;
    } else if (asked_.kind == I2cPhaseKind::Write) {
        accesses_.push_back({now, false, pointer_, asked_.byte});
    }
    if (now - begin >= kShortest) busy_.push_back({begin, now});
}

}  // namespace puckloop::tools
