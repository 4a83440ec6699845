#pragma once
// The slave of an AVR's two-wire interface on the wires. Source: ATmega1284P data sheet (8272), "2-wire
// Serial Interface": address match unit, tables of status codes for slave receiver and slave transmitter, bus
// errors.

#include "tests/wires/wire_slave.h"

namespace puckloop::wires {

class WireTwi : public WireSlave {
  public:
    struct Setup {
        std::uint8_t address = 0, mask = 0;  ///< TWAR7:1 and TWAMR7:1, shifted as there
        bool general_call = false;
    };
    struct Service {
        std::uint8_t status = 0, data = 0;
        bool operator==(const Service&) const = default;
    };
    explicit WireTwi(const Setup& setup) : setup_(setup) {}

    void start() override {
        const bool error = broken();
        if (mode_ == Mode::Receive && !error) serve(0xA0);
        count_ = 0;
        mode_ = error ? Mode::Idle : Mode::Address;
        if (error) serve(0x00);
    }
    void stop() override {
        const bool error = broken();
        const bool receives = mode_ == Mode::Receive;
        count_ = 0;
        mode_ = Mode::Idle;
        if (error)
            serve(0x00);
        else if (receives)
            serve(0xA0);
    }
    bool lets_go() const override {
        return mode_ != Mode::Transmit || count_ == 8 || (twdr_ >> (7 - count_) & 1) != 0;
    }
    bool clock(bool sda) override {
        if (count_ < 8) {
            const bool line = sda && lets_go();
            shift_ = static_cast<std::uint8_t>(shift_ << 1 | (line ? 1 : 0));
            ++count_;
            return line;
        }
        count_ = 0;
        bool pulls = false;
        if (mode_ == Mode::Address) {
            const bool general = shift_ == 0 && setup_.general_call;
            pulls = twea_ && (general || ((shift_ ^ setup_.address) & ~setup_.mask & 0xFE) == 0);
            general_ = general;
        } else if (mode_ == Mode::Receive) {
            pulls = twea_;
        }
        const bool line = sda && !pulls;
        ninth(pulls, line);
        return line;
    }
    /// The next clock is one of a byte of its own.
    bool sends() const { return mode_ == Mode::Transmit && count_ == 0; }
    const std::vector<Service>& served() const { return served_; }

  private:
    enum class Mode { Idle, Address, Receive, Transmit };

    /// A START or STOP is now where none may be.
    bool broken() const { return mode_ != Mode::Idle && count_ > 0; }

    void ninth(bool pulls, bool line) {
        switch (mode_) {
        case Mode::Address:
            if (!pulls) {
                mode_ = Mode::Idle;
                return;
            }
            twdr_ = shift_;
            mode_ = (shift_ & 1) != 0 ? Mode::Transmit : Mode::Receive;
            serve(general_ ? 0x70 : mode_ == Mode::Transmit ? 0xA8 : 0x60);
            return;
        case Mode::Receive:
            twdr_ = shift_;
            if (!pulls) mode_ = Mode::Idle;
            serve(general_ ? (pulls ? 0x90 : 0x98) : (pulls ? 0x80 : 0x88));
            return;
        case Mode::Transmit:
            twdr_ = shift_;  // what was on the line
            if (line || !twea_) mode_ = Mode::Idle;
            serve(line ? 0xC0 : twea_ ? 0xB8 : 0xC8);
            return;
        case Mode::Idle:
            return;
        }
    }

    /// The program of the test: what it answers to each status.
    void serve(std::uint8_t status) {
        // Only what a program may rely on: the last byte on the line is not that of a bus error or a STOP.
        const bool shifted = status == 0x60 || status == 0x70 || (status >= 0x80 && status <= 0x98) ||
                             (status >= 0xA8 && status <= 0xC8);
        served_.push_back({status, shifted ? twdr_ : std::uint8_t{0}});
        const std::uint16_t drawn = policy_.next();
        const bool may_refuse =
            status == 0x60 || status == 0x70 || status == 0x80 || status == 0x90 || status == 0xB8;
        twea_ = !may_refuse || (drawn >> 14 & 1) != 0 || (drawn >> 12 & 1) != 0;
        if (may_refuse && (drawn >> 10 & 3) == 0) mode_ = Mode::Idle;  // TWSTO
        if (status == 0xA8 || status == 0xB8) twdr_ = static_cast<std::uint8_t>(drawn ^ drawn >> 8);
    }

    Setup setup_;
    Policy policy_;
    Mode mode_ = Mode::Idle;
    int count_ = 0;
    std::uint8_t shift_ = 0, twdr_ = 0;
    bool twea_ = true, general_ = false;
    std::vector<Service> served_;
};

}  // namespace puckloop::wires
