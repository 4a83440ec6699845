#pragma once
// CAN1 and CAN2 of the 30F: three transmit buffers, two receive buffers, six filters and two masks on top of
// what all CAN modules have in common (can_line.h, with its deviations). Source: dsPIC30F Family Reference
// Manual, section 23 (DS70070), and DS70143.

#include "emu/dspic/peripherals/can/can_line.h"

#include <cstdint>
#include <optional>

namespace puckloop::dspic {

class Can : public CanLine {
  public:
    struct Setup {
        int unit = 1;
        std::uint16_t base = 0;  ///< CxRXF0SID; all others follow at fixed distances
        std::uint8_t irq = 0;
        PortLetter port{};
        std::uint8_t rx = 0, tx = 0;
    };
    static constexpr int kWords = 78;  ///< from the first register to the last
    /// CxCTRL.
    static constexpr std::uint16_t control(const Setup& setup) {
        return static_cast<std::uint16_t>(setup.base + 0x90);
    }
    Can(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock, Ports& ports,
        Pins& pins);

    void reset() { reset_line(); }

  private:
    static void write_transmit(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_receive(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_setup(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_control(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_interrupts(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);

    std::uint16_t& at(int offset) const { return reg(static_cast<std::uint16_t>(setup_.base + offset)); }
    std::uint16_t& control_register(int buffer) const;
    std::uint8_t control_of(int buffer) const override;
    void set_control(int buffer, std::uint8_t control) override;
    CanFrame frame_of(int buffer, Cycle now) override;
    void was_sent(int buffer, Cycle now) override;
    void show_code() override;

    // Reception (can_receive.cpp).
    void deliver(const CanFrame& frame, Cycle now) override;
    std::optional<int> filter_hit(const CanFrame& frame, int first, int last, int mask) const;
    void store(int buffer, const CanFrame& frame, int filter, Cycle now);

    Setup setup_;
};

}  // namespace puckloop::dspic
