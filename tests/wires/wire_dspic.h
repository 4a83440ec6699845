#pragma once
// The slave of a dsPIC's I2C module on the wires. Source: dsPIC30F Family Reference Manual (DS70068), section
// 21.7, dsPIC33F (DS70195), section 7: address match, table of what is done with a received byte by RBF and
// I2COV, slave transmission, resets by NACK, START and STOP.

#include "tests/wires/wire_slave.h"

#include <optional>

namespace puckloop::wires {

class WireDspic : public WireSlave {
  public:
    struct Setup {
        std::uint16_t address = 0, mask = 0;
        bool ten_bits = false, general_call = false, stretches = false;
        std::uint8_t transmit = 0;  ///< I2CTRN at first
    };
    explicit WireDspic(const Setup& setup) : setup_(setup), trn_(setup.transmit) {}

    void start() override {
        s_ = true;
        p_ = false;
        mode_ = Mode::Address;
        count_ = 0;
    }
    void stop() override {
        p_ = true;
        s_ = general_ = add10_ = whole_ = false;
        mode_ = Mode::Idle;
        count_ = 0;
    }
    bool lets_go() const override { return mode_ != Mode::Transmit || bit_to_send(); }
    bool clock(bool sda) override {
        if (count_ < 8) {
            const bool line = sda && lets_go();
            shift_ = static_cast<std::uint8_t>(shift_ << 1 | (line ? 1 : 0));
            if (++count_ == 8) eighth();
            return line;
        }
        count_ = 0;
        const bool line = sda && !pulls_;
        ninth(line);
        return line;
    }

    /// GCSTAT 9, ADD10 8, IWCOL 7, I2COV 6, D_A 5, P 4, S 3, R_W 2, RBF 1, TBF 0.
    std::uint16_t status() const {
        unsigned bits = 0;
        for (const bool bit : {general_, add10_, iwcol_, overflow_, data_, p_, s_, reads_, full_, loaded_})
            bits = bits << 1 | (bit ? 1u : 0u);
        return static_cast<std::uint16_t>(bits);
    }
    /// The next clock is one of a byte of its own.
    bool sends() const { return mode_ == Mode::Transmit && count_ == 0; }
    std::uint8_t received() const { return rcv_; }
    int interrupts() const { return interrupts_; }
    /// Bytes that were put into I2CTRN between the eighth and the ninth clock of the one before.
    int loaded_early() const { return loaded_early_; }

  private:
    enum class Mode { Idle, Address, SecondByte, Receive, Transmit };

    bool bit_to_send() const { return count_ == 8 || (trn_ >> (7 - count_) & 1) != 0; }

    bool matches() const {
        if (shift_ == 0) return setup_.general_call;
        if (!setup_.ten_bits) return ((shift_ >> 1 ^ setup_.address) & ~setup_.mask & 0x7F) == 0;
        const bool fits =
            (shift_ & 0xF8) == 0xF0 && ((shift_ >> 1 ^ setup_.address >> 8) & ~(setup_.mask >> 8) & 3) == 0;
        return fits && ((shift_ & 1) == 0 || whole_);
    }

    void eighth() {
        const bool room = !full_ && !overflow_;
        pulls_ = false;
        switch (mode_) {
        case Mode::Address:
            fits_ = matches();
            if (!fits_ || shift_ == 0) whole_ = false;
            pulls_ = fits_ && room;
            break;
        case Mode::SecondByte:
            fits_ = ((shift_ ^ setup_.address) & ~setup_.mask & 0xFF) == 0;
            pulls_ = fits_ && room;
            break;
        case Mode::Receive:
            pulls_ = room;
            break;
        case Mode::Transmit:
            loaded_ = false;
            if (!next_) break;
            trn_ = *next_;  // the program waited for it
            loaded_ = data_ = true;
            next_.reset();
            ++loaded_early_;
            break;
        case Mode::Idle:
            break;
        }
    }

    void ninth(bool line) {
        switch (mode_) {
        case Mode::Address: {
            if (!fits_) return leave();
            const bool first_of_ten = setup_.ten_bits && shift_ != 0 && (shift_ & 1) == 0;
            if (first_of_ten) {
                whole_ = false;
                mode_ = pulls_ ? Mode::SecondByte : Mode::Idle;
                return;
            }
            const bool sends = (shift_ & 1) != 0;
            mode_ = !pulls_ ? Mode::Idle : sends ? Mode::Transmit : Mode::Receive;
            reads_ = sends;
            general_ = shift_ == 0;
            add10_ = setup_.ten_bits && whole_;
            take(false);
            return;
        }
        case Mode::SecondByte:
            if (!pulls_) return leave();
            mode_ = Mode::Receive;
            whole_ = add10_ = true;
            reads_ = general_ = false;
            take(false);
            return;
        case Mode::Receive:
            take(true);
            return;
        case Mode::Transmit:
            if (line) {  // "resets": what the program loaded meanwhile goes too
                loaded_ = false;
                leave();
            } else {
                interrupt();
            }
            return;
        case Mode::Idle:
            return;
        }
    }

    void leave() { mode_ = Mode::Idle; }

    void take(bool data) {
        if (full_) {
            overflow_ = true;
        } else {
            rcv_ = shift_;
            full_ = true;
        }
        data_ = data;
        interrupt();
    }

    /// The service routine of the test's program; it always lets SCL go.
    void interrupt() {
        ++interrupts_;
        const std::uint16_t drawn = policy_.next();
        const auto bit = [drawn](int n) { return (drawn >> n & 1) != 0; };
        if (reads_ && !overflow_ && (bit(13) || bit(10))) {
            if (loaded_) {
                iwcol_ = true;
            } else {
                trn_ = static_cast<std::uint8_t>(drawn >> 2);
                loaded_ = data_ = true;
                if (bit(9)) next_ = static_cast<std::uint8_t>(drawn >> 5);
            }
        }
        if (bit(14) || bit(12)) full_ = false;
        if (bit(15) || bit(11)) overflow_ = false;
    }

    Setup setup_;
    Policy policy_;
    Mode mode_ = Mode::Idle;
    int count_ = 0, interrupts_ = 0, loaded_early_ = 0;
    std::uint8_t shift_ = 0, rcv_ = 0, trn_;
    std::optional<std::uint8_t> next_{};
    bool fits_ = false, pulls_ = false, whole_ = false;
    bool general_ = false, add10_ = false, iwcol_ = false, overflow_ = false, data_ = false, p_ = false,
         s_ = false, reads_ = false, full_ = false, loaded_ = false;
};

}  // namespace puckloop::wires
