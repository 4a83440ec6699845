#pragma once
// The master of an AVR's two-wire interface on the wires, one operation after the other. Source: data sheet
// 8272, "2-wire Serial Interface": TWINT, TWWC and TWDR of the register description, tables "Status Codes for
// Master Transmitter Mode" and "Master Receiver Mode", bit rate generator.

#include <cstdint>

namespace puckloop::wires {

class WireTwiMaster {
  public:
    /// What appears on the wires once TWINT is cleared.
    enum class Wire : std::uint8_t { None, Start, Address, Write, Read, Stop, StopAndStart };

    void write_data(std::uint8_t byte) {
        write_collision_ = !interrupt_;
        if (interrupt_) data_ = byte;
    }
    /// TWCR with TWEN, and with TWINT, which ends the wait of what went before.
    Wire control(bool start, bool stop, bool acknowledges) {
        interrupt_ = false;
        meets_byte_ = owner_ && (status_ == 0x40 || status_ == 0x50);
        acknowledges_ = acknowledges;
        if (stop) return wire_ = start ? Wire::StopAndStart : Wire::Stop;
        if (start) return wire_ = Wire::Start;
        switch (status_) {
        case 0x08:
        case 0x10:
            reads_ = (data_ & 1) != 0;
            return wire_ = Wire::Address;
        case 0x18:
        case 0x20:
        case 0x28:
        case 0x30:
            return wire_ = Wire::Write;
        case 0x40:
        case 0x50:
            return wire_ = Wire::Read;
        default:
            return wire_ = Wire::None;
        }
    }
    /// The wires have gone through it. `others`: what slaves and other masters leave of SDA in eight clocks;
    /// `low`: whether one of them pulls it low in the ninth.
    void finish(std::uint8_t others, bool low) {
        switch (wire_) {
        case Wire::Start:
            if (meets_byte_ && others < 0x80) return end(0x38, false);
            return end(owner_ ? 0x10 : 0x08, true);
        case Wire::StopAndStart:
            if (meets_byte_ && others < 0x80) return end(0x38, false);
            return end(0x08, true);
        case Wire::Stop:
            if (meets_byte_ && others < 0x80) return end(0x38, false);
            status_ = 0xF8;
            owner_ = false;
            return;
        case Wire::Address:
        case Wire::Write: {
            if ((data_ & ~others) != 0) {  // goes on shifting as a slave
                data_ = line(others);
                return end(0x38, false);
            }
            const int ack = wire_ == Wire::Write ? 0x28 : reads_ ? 0x40 : 0x18;
            return end(low ? ack : ack + 8, true);
        }
        case Wire::Read:
            data_ = others;
            if (acknowledges_) return end(0x50, true);
            return end(low ? 0x38 : 0x58, !low);
        case Wire::None:  // a slave that nobody addresses
            status_ = 0xF8;
            return;
        }
    }

    /// Eight clocks: a master that has lost a bit lets SDA be from then on.
    std::uint8_t line(std::uint8_t others) const {
        std::uint8_t line = 0;
        bool drives = true;
        for (int bit = 7; bit >= 0; --bit) {
            const bool own = !drives || (data_ >> bit & 1) != 0, other = (others >> bit & 1) != 0;
            drives = drives && own == (own && other);
            line = static_cast<std::uint8_t>(line << 1 | (own && other ? 1 : 0));
        }
        return line;
    }
    int status() const { return status_; }
    std::uint8_t data() const { return data_; }
    bool interrupt() const { return interrupt_; }
    bool write_collision() const { return write_collision_; }
    bool owner() const { return owner_; }
    /// A slave that is to send has its first bit on SDA.
    bool meets_byte() const { return meets_byte_; }

  private:
    void end(int status, bool owner) {
        status_ = status;
        owner_ = owner;
        interrupt_ = true;
    }

    Wire wire_ = Wire::None;
    int status_ = 0xF8;
    std::uint8_t data_ = 0xFF;
    bool interrupt_ = false, write_collision_ = false, owner_ = false, reads_ = false, acknowledges_ = false,
         meets_byte_ = false;
};

}  // namespace puckloop::wires
