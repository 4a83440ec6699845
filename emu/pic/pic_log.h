#pragma once
// The log of a main board: what its chip went through (emu/board/chip_log.h), wheels and LEDs.

#include "emu/board/chip_log.h"
#include "emu/pic/board.h"
#include "emu/pic/motor_log.h"

#include <array>
#include <string>

namespace puckloop::pic {

class PicLog {
  public:
    /// As ChipLog.
    PicLog(const std::string& path, const image::Image& image) : chip_(path, image) {}

    cosim::Time next_look() const { return chip_.next_look(); }
    void look(const dspic::Chip& chip);
    void end(cosim::Time now, const dspic::Chip& chip, const Board& board);

    void signal_changed(SignalId id, double value, cosim::Time now);
    /// Both at the stop bit.
    void sent(int unit, const cosim::UartFrame& frame, cosim::Time now) { chip_.sent(unit, frame, now); }
    void arrived(int unit, const cosim::UartFrame& frame, cosim::Time now, bool listening) {
        chip_.arrived(unit, frame, now, listening);
    }

    template <class Archive>
    void state(Archive& archive) {
        archive(chip_, motors_, changes_);
    }
    void loaded(cosim::Time now) { chip_.loaded(now); }
    /// As ChipLog.
    void mark() { chip_.mark(); }
    void rewind() { chip_.rewind(); }
    void settle() { chip_.settle(); }

  private:
    board::ChipLog chip_;
    std::array<MotorLog, 2> motors_{MotorLog("left"), MotorLog("right")};
    std::array<std::uint64_t, kSignalCount> changes_{};
};

}  // namespace puckloop::pic
