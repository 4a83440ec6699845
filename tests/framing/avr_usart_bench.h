#pragma once
// USART1 of an ATmega1284P at 16 MHz without the processor, with a clock that may be off.

#include "emu/avr/peripherals/serial/usart.h"
#include "tests/framing/uart_line.h"

#include <vector>

namespace puckloop::framing {

struct AvrPins : avr::Pins {
    void uart_sent(int, const cosim::UartFrame& frame) override { frames.push_back(frame); }
    std::vector<cosim::UartFrame> frames;
};

struct AvrUsartBench {
    static constexpr std::uint8_t kRxc = 0x80, kUdre = 0x20, kFe = 0x10, kDor = 0x08, kUpe = 0x04;
    static constexpr std::uint16_t kBase = 0xC8;

    explicit AvrUsartBench(double ppm) : clock(16e6, ppm) {
        io.describe(avr::atmega1284p().registers);
        usart.reset();
    }

    /// Returns the first cycle of the sampling clock.
    std::uint64_t enable(const Format& format, std::uint32_t divisor, bool double_speed) {
        const unsigned size = static_cast<unsigned>(format.data_bits == 9 ? 7 : format.data_bits - 5);
        const unsigned parity = format.parity == 2 ? 2 : format.parity == 1 ? 3 : 0;
        write(0, double_speed ? 2 : 0);
        write(2, static_cast<std::uint8_t>(parity << 4 | (size & 3) << 1));
        write(5, static_cast<std::uint8_t>((divisor - 1) >> 8));
        write(4, static_cast<std::uint8_t>(divisor - 1));
        write(1, static_cast<std::uint8_t>(0x18 | (size & 4)));
        return now + 1;
    }
    void go(std::uint64_t cycle) {
        while (events.next() <= cycle) {
            now = events.next();
            events.service(now);
        }
        now = cycle;
    }
    std::uint8_t status() { return read(0); }
    std::uint16_t data() {
        const unsigned ninth = read(1) >> 1 & 1u;  // RXB8, to be read first
        return static_cast<std::uint16_t>(read(6) | ninth << 8);
    }
    bool send(std::uint16_t word) {
        if (!(status() & kUdre)) return false;
        const std::uint8_t b = read(1);
        write(1, static_cast<std::uint8_t>((b & ~1) | (word >> 8 & 1)));
        write(6, static_cast<std::uint8_t>(word));
        return true;
    }

    avr::IoSpace io;
    avr::EventQueue events;
    avr::InterruptController interrupts;
    avr::Cycle now = 0;
    avr::Surroundings around{io, events, interrupts, now};
    cosim::ClockDomain clock;
    AvrPins pins;
    avr::Ports ports{around, pins};
    avr::Usart usart{
        around,
        {1, kBase, 28, {avr::PortLetter::D, 2}, {avr::PortLetter::D, 3}, {avr::PortLetter::D, 4}, 0x10},
        clock,
        ports,
        pins};

  private:
    std::uint8_t read(int offset) { return io.read(static_cast<std::uint16_t>(kBase + offset)); }
    void write(int offset, std::uint8_t value) {
        io.write(static_cast<std::uint16_t>(kBase + offset), value, 0xFF);
    }
};

}  // namespace puckloop::framing
