// The modules of the dsPIC30F6014A and their pins. Source: DS70143 and its family reference manual.

#include "emu/dspic/devices/dspic30f6014a_irq.h"
#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/layouts/layout.h"

namespace puckloop::dspic {

namespace {

using enum PortLetter;

constexpr Ports::Place kPorts[] = {
    {A, sfr::TRISA, sfr::PORTA, sfr::LATA}, {B, sfr::TRISB, sfr::PORTB, sfr::LATB},
    {C, sfr::TRISC, sfr::PORTC, sfr::LATC}, {D, sfr::TRISD, sfr::PORTD, sfr::LATD},
    {F, sfr::TRISF, sfr::PORTF, sfr::LATF}, {G, sfr::TRISG, sfr::PORTG, sfr::LATG},
};
constexpr Ports::Pin kAnalog[] = {
    {B, 0}, {B, 1}, {B, 2},  {B, 3},  {B, 4},  {B, 5},  {B, 6},  {B, 7},
    {B, 8}, {B, 9}, {B, 10}, {B, 11}, {B, 12}, {B, 13}, {B, 14}, {B, 15},
};

constexpr TimerPlace kTimers[] = {
    {1, {sfr::TMR1, sfr::PR1, sfr::T1CON, irq::T1, 0, true}, {C, 14}},
    {3, {sfr::TMR3, sfr::PR3, sfr::T3CON, irq::T3}, {C, 2}},
    {2, {sfr::TMR2, sfr::PR2, sfr::T2CON, irq::T2, sfr::TMR3HLD}, {C, 1}},
    {5, {sfr::TMR5, sfr::PR5, sfr::T5CON, irq::T5}, {C, 4}},
    {4, {sfr::TMR4, sfr::PR4, sfr::T4CON, irq::T4, sfr::TMR5HLD}, {C, 3}},
};

constexpr Uart::Setup kUarts[] = {
    {1, sfr::U1MODE, irq::U1RX, irq::U1TX, F, 2, 3},
    {2, sfr::U2MODE, irq::U2RX, irq::U2TX, F, 4, 5},
};

constexpr I2cMaster::Setup kI2cs[] = {
    {1, sfr::I2CRCV, false, irq::MI2C, irq::SI2C, G, 2, 3, 1'111'111.0},
};

constexpr std::uint8_t kNoIrq = 255;
constexpr Spi::Setup kSpis[] = {
    {1, sfr::SPI1STAT, irq::SPI1, kNoIrq, F, 6, 7, 8, {B, 2}, 0, sfr::SPI1BUF},
    {2, sfr::SPI2STAT, irq::SPI2, kNoIrq, G, 6, 7, 8, {G, 9}, 0, sfr::SPI2BUF},
};

constexpr Can::Setup kCans[] = {
    {1, sfr::C1RXF0SID, irq::C1, F, 0, 1},
    {2, sfr::C2RXF0SID, irq::C2, G, 0, 1},
};

constexpr OutputCompare::Unit kOutputCompares[] = {
    {sfr::OC1RS, irq::OC1, D, 0}, {sfr::OC2RS, irq::OC2, D, 1}, {sfr::OC3RS, irq::OC3, D, 2},
    {sfr::OC4RS, irq::OC4, D, 3}, {sfr::OC5RS, irq::OC5, D, 4}, {sfr::OC6RS, irq::OC6, D, 5},
    {sfr::OC7RS, irq::OC7, D, 6}, {sfr::OC8RS, irq::OC8, D, 7},
};

constexpr InputCapture::Unit kInputCaptures[] = {
    {sfr::IC1BUF, irq::IC1, {D, 8}},  {sfr::IC2BUF, irq::IC2, {D, 9}},  {sfr::IC3BUF, irq::IC3, {D, 10}},
    {sfr::IC4BUF, irq::IC4, {D, 11}}, {sfr::IC5BUF, irq::IC5, {D, 12}}, {sfr::IC6BUF, irq::IC6, {D, 13}},
    {sfr::IC7BUF, irq::IC7, {D, 14}}, {sfr::IC8BUF, irq::IC8, {D, 15}},
};
constexpr Ports::Pin kOcfa{B, 6}, kOcfb{B, 15};

constexpr Layout kLayout = {
    .ports =
        {kPorts, kAnalog, {sfr::ADPCFG, 0}, 0, {sfr::CNEN1, sfr::CNEN2}, {sfr::CNPU1, sfr::CNPU2}, irq::CN},
    .external_irqs = {irq::INT0, irq::INT1, irq::INT2, irq::INT3, irq::INT4},
    .timers = kTimers,
    .uarts = kUarts,
    .i2cs = kI2cs,
    .adc12 = true,
    .adc_timers = {3, 0},
    .spis = kSpis,
    // DS70061, figures 14-1 to 14-9: one cycle to the pin, two more to the flag.
    .output_compare = {kOutputCompares, {kOcfa, kOcfb}, 1, 2},
    .input_captures = kInputCaptures,
    .cans = kCans,
    .dci = {sfr::DCICON1, irq::DCI, 0, G, 12, 13, 14, 15},
    .low_voltage_irq = irq::LVD,
};

}  // namespace

const Layout& layout_dspic30f6014a() {
    return kLayout;
}

}  // namespace puckloop::dspic
