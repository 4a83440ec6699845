#include "emu/dspic/peripherals/ports.h"

#include "emu/dspic/peripherals/external_interrupts.h"
#include "tests/dspic/peripherals/peripheral_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

struct PortsBench : Bench {
    Ports ports{around, layout_dspic30f6014a().ports, pins};
    ExternalInterrupts external{around, ports, layout_dspic30f6014a().external_irqs};

    PortsBench() { ports.reset(); }
    void outside(PortLetter port, std::uint16_t levels, Cycle at) {
        go(at);
        pins.outside[port] = levels;
        ports.outside_changed(port, at);
    }
};

}  // namespace

TEST_CASE_METHOD(PortsBench, "TRIS makes outputs, LAT sets them, PORT reads pins") {
    pins.outside[PortLetter::D] = 0xFF00;
    CHECK(read(sfr::PORTD) == 0xFF00);
    write(sfr::LATD, 0x00A5);
    CHECK(pins.drives.empty());  // all still inputs
    write(sfr::TRISD, 0xFF00);
    REQUIRE(pins.drives.size() == 1);
    CHECK(pins.drives[0].driven == 0x00FF);
    CHECK(pins.drives[0].levels == 0x00A5);
    CHECK(read(sfr::PORTD) == 0xFFA5);
    write(sfr::PORTD, 0x0001);  // goes to the latch
    CHECK(read(sfr::LATD) == 0x0001);
    CHECK(read(sfr::PORTD) == 0xFF01);
    CHECK(pins.drives.size() == 2);
    write(sfr::LATD, 0x0001);
    CHECK(pins.drives.size() == 2);  // nothing changed
}

TEST_CASE_METHOD(PortsBench, "only implemented pins exist, and analog pins read 0") {
    pins.outside[PortLetter::A] = 0xFFFF;
    CHECK(read(sfr::PORTA) == 0xF6C0);
    pins.outside[PortLetter::B] = 0xFFFF;
    CHECK(read(sfr::PORTB) == 0x0000);  // ADPCFG = 0: all analog
    sfr.raw(sfr::ADPCFG) = 0x00F0;
    CHECK(read(sfr::PORTB) == 0x00F0);
}

TEST_CASE_METHOD(PortsBench, "a byte write leaves the other half alone") {
    write(sfr::TRISD, 0);
    write(sfr::LATD, 0x1234);
    sfr.write(sfr::LATD, 0xAB00, 0xFF00);
    CHECK(read(sfr::LATD) == 0xAB34);
    sfr.write(sfr::LATD, 0x00CD, 0x00FF);
    CHECK(read(sfr::LATD) == 0xABCD);
    CHECK(pins.drives.back().levels == 0xABCD);
}

TEST_CASE_METHOD(PortsBench, "pins taken over follow their module and come back") {
    write(sfr::LATG, 0x000C);
    write(sfr::TRISG, 0xF3C3);
    CHECK(pins.drives.back().driven == 0x000C);
    ports.take_over(PortLetter::G, 0x000C, 0, 0);
    CHECK(pins.drives.back().driven == 0);
    ports.release(PortLetter::G, 0x000C);
    CHECK(pins.drives.back().driven == 0x000C);
    CHECK(pins.drives.back().levels == 0x000C);
}

TEST_CASE_METHOD(PortsBench, "INT0 interrupts at the chosen edge") {
    outside(PortLetter::F, 1 << 6, 100);
    CHECK(take(irq::INT0));
    outside(PortLetter::F, 0, 200);
    CHECK_FALSE(take(irq::INT0));
    write(sfr::INTCON2, 1);  // falling
    outside(PortLetter::F, 1 << 6, 300);
    CHECK_FALSE(take(irq::INT0));
    outside(PortLetter::F, 0, 400);
    CHECK(take(irq::INT0));
}

TEST_CASE_METHOD(PortsBench, "change notification compares with the last read of the port") {
    write(sfr::CNEN1, 1 << 8);  // CN8 = RG6
    outside(PortLetter::G, 1 << 6, 100);
    CHECK(take(irq::CN));
    read(sfr::PORTG);
    outside(PortLetter::G, 1 << 6 | 1 << 7, 200);  // CN9 is not enabled
    CHECK_FALSE(take(irq::CN));
    outside(PortLetter::G, 0, 300);
    CHECK(take(irq::CN));
    outside(PortLetter::G, 1 << 6, 400);  // back to what was read
    CHECK_FALSE(take(irq::CN));
}
