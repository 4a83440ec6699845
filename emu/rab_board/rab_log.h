#pragma once
// The log of a range-and-bearing board: what its chip went through (emu/board/chip_log.h), the text it prints
// on UART2, frames it emitted, what the bus asked of it.

#include "emu/board/chip_log.h"
#include "emu/rab_board/board.h"
#include "emu/rab_board/frame_watch.h"
#include "emu/rab_board/i2c_watch.h"

#include <string>

namespace puckloop::rab {

class RabLog {
  public:
    /// As ChipLog.
    RabLog(const std::string& path, const image::Image& image);
    RabLog(const RabLog&) = delete;
    RabLog& operator=(const RabLog&) = delete;

    cosim::Time next_look() const { return chip_.next_look(); }
    void look(const dspic::Chip& chip);
    void end(cosim::Time now, const dspic::Chip& chip);

    void signal_changed(SignalId id, double value, cosim::Time now);
    void emitters(std::uint16_t on, cosim::Time now) { frames_.change(on, now); }
    /// Both at the stop bit.
    void sent(int unit, const cosim::UartFrame& frame, cosim::Time now);
    void arrived(int unit, const cosim::UartFrame& frame, cosim::Time now, bool listening) {
        chip_.arrived(unit, frame, now, listening);
    }
    void i2c_phase(const cosim::I2cPhase& phase, cosim::Time now) { i2c_.phase(phase, now); }
    void i2c_answer(const cosim::I2cPhase& answer, cosim::Time now) { i2c_.answer(answer, now); }

    /// They count without a log as well.
    const FrameWatch& frames() const { return frames_; }
    const I2cWatch& i2c() const { return i2c_; }

    template <class Archive>
    void state(Archive& archive) {
        archive(chip_, frames_, i2c_, line_, codes_, carrier_);
        archive.bounded(lines_, 0, 1000);
    }
    void loaded(cosim::Time now) { chip_.loaded(now); }
    /// As ChipLog.
    void mark() { chip_.mark(); }
    void rewind() { chip_.rewind(); }
    void settle() { chip_.settle(); }

  private:
    void frame(const EmittedFrame& frame);
    void text(char character, cosim::Time now);

    board::ChipLog chip_;
    FrameWatch frames_;
    I2cWatch i2c_;
    std::string line_;
    int lines_ = 0;
    std::uint64_t codes_ = 0;
    bool carrier_ = false;
};

}  // namespace puckloop::rab
