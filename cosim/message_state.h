#pragma once
// What messages carry, as part of a saved state (base/archive.h).

#include "base/archive.h"
#include "cosim/message.h"

namespace puckloop::cosim {

/// An empty frame (bit_period 0) is a legal state; who samples frames checks for it.
template <class Archive>
void state(Archive& archive, UartFrame& frame) {
    archive(frame.start);
    archive.bounded(frame.bit_period, 0, kSecond);
    archive(frame.data);
    archive.bounded(frame.data_bits, 5, 9);
    archive.bounded(frame.parity, 0, 2);
    archive.bounded(frame.stop_bits, 1, 2);
    archive.bounded(frame.parity_bit, 0, 1);
    archive.bounded(frame.is_break, 0, 1);
}

template <class Archive>
void state(Archive& archive, I2cPhase& phase) {
    archive.bounded(phase.kind, I2cPhaseKind::Start, I2cPhaseKind::BusLost);
    archive(phase.byte);
    archive.bounded(phase.ack, 0, 1);
    archive(phase.start);
    archive.bounded(phase.clock_period, 0, kSecond);
    archive.bounded(phase.stretch, 0, kNever);
}

}  // namespace puckloop::cosim
