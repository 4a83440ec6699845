#pragma once
// UART2 of a dsPIC30F6014A at the e-puck's clock, or UART1 of a dsPIC33FJ256GP710 at the range-and-bearing
// board's, with a clock that may be off.

#include "emu/dspic/layouts/layout.h"
#include "tests/dspic/peripherals/peripheral_bench.h"
#include "tests/framing/uart_line.h"

namespace puckloop::framing {

struct DspicUartBench : dspic::test::Bench {
    static constexpr std::uint16_t kPerr = 0x8, kFerr = 0x4, kOerr = 0x2, kUrxda = 0x1;
    static constexpr double kFcy33 = 41e6;

    DspicUartBench(bool family, double ppm)
        : Bench(family ? dspic::dspic33fj256gp710() : dspic::dspic30f6014a()),
          family_33f(family),
          setup(family ? dspic::layout_dspic33fj256gp710().uarts[0] : dspic::layout_dspic30f6014a().uarts[1]),
          ports(around, (family ? dspic::layout_dspic33fj256gp710() : dspic::layout_dspic30f6014a()).ports,
                pins),
          uart(around, setup, clock, ports, pins) {
        clock = cosim::ClockDomain(family ? kFcy33 : dspic::test::kFcy, ppm);
    }

    void enable(const Format& format, std::uint32_t divisor, bool high_speed) {
        const int select = format.data_bits == 9 ? 3 : format.parity == 2 ? 1 : format.parity == 1 ? 2 : 0;
        write(at(8), static_cast<std::uint16_t>(divisor - 1));
        write(at(0), static_cast<std::uint16_t>(0x8000 | (high_speed ? 8 : 0) | select << 1 |
                                                (format.stop_bits == 2 ? 1 : 0)));
        write(at(2), 0x0400);
        interrupts.clear(setup.rx_irq);
        interrupts.clear(setup.tx_irq);
    }
    std::uint16_t sta() { return read(at(2)); }
    std::uint16_t data() { return read(at(6)); }
    bool send(std::uint16_t word) {
        if (sta() & 0x0200) return false;  // UTXBF
        write(at(4), word);
        return true;
    }
    void clear_overrun() { write(at(2), static_cast<std::uint16_t>(sta() & ~kOerr)); }

    bool family_33f;
    dspic::Uart::Setup setup;
    dspic::Ports ports;
    dspic::Uart uart;

  private:
    std::uint16_t at(int offset) const { return static_cast<std::uint16_t>(setup.mode + offset); }
};

}  // namespace puckloop::framing
