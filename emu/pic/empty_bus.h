#pragma once
// An I2C bus with nobody on it but the master: no address is acknowledged, every byte reads 0xFF.

#include "cosim/core/message.h"
#include "cosim/core/message_state.h"
#include "cosim/core/time.h"

#include <optional>

namespace puckloop::pic {

class EmptyBus {
  public:
    static constexpr int kClocksOfByte = 9;

    /// Returns due(), up to which the master may run on.
    cosim::Time phase(const cosim::I2cPhase& phase) {
        if (phase.kind == cosim::I2cPhaseKind::Stop) return due();
        pending_ = phase;
        pending_->kind = phase.kind == cosim::I2cPhaseKind::Read ? cosim::I2cPhaseKind::Data
                                                                 : cosim::I2cPhaseKind::Acknowledge;
        if (phase.kind == cosim::I2cPhaseKind::Read) pending_->byte = 0xFF;
        pending_->ack = 0;
        due_ = phase.start + kClocksOfByte * phase.clock_period;
        return due_;
    }
    /// When the answer to the last phase is due: the end of its ninth clock.
    cosim::Time due() const { return pending_ ? due_ : cosim::kNever; }
    cosim::I2cPhase take() {
        const cosim::I2cPhase answer = *pending_;
        pending_.reset();
        return answer;
    }
    template <class Archive>
    void state(Archive& archive) {
        archive(pending_);
        archive.bounded(due_, 0, cosim::kNever);
    }

  private:
    std::optional<cosim::I2cPhase> pending_;
    cosim::Time due_ = 0;
};

}  // namespace puckloop::pic
