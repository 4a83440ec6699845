// The modules of the dsPIC33FJ256GP710 (100 pins) and their pins. Source: DS70286, pin diagram and tables.
// Not modelled: CRC; their registers are reported when touched.

#include "emu/dspic/devices/dspic33fj256gp710_irq.h"
#include "emu/dspic/devices/dspic33fj256gp710_sfr.h"
#include "emu/dspic/layouts/layout.h"

namespace puckloop::dspic {

namespace {

using enum PortLetter;
namespace sfr = sfr33;
namespace irq = irq33;

constexpr Ports::Place kPorts[] = {
    {A, sfr::TRISA, sfr::PORTA, sfr::LATA, sfr::ODCA},
    {B, sfr::TRISB, sfr::PORTB, sfr::LATB},
    {C, sfr::TRISC, sfr::PORTC, sfr::LATC},
    {D, sfr::TRISD, sfr::PORTD, sfr::LATD, sfr::ODCD},
    {E, sfr::TRISE, sfr::PORTE, sfr::LATE},
    {F, sfr::TRISF, sfr::PORTF, sfr::LATF, sfr::ODCF},
    {G, sfr::TRISG, sfr::PORTG, sfr::LATG, sfr::ODCG},
};
constexpr Ports::Pin kAnalog[] = {
    {B, 0}, {B, 1}, {B, 2},  {B, 3},  {B, 4},  {B, 5},  {B, 6},  {B, 7},   // AN0
    {B, 8}, {B, 9}, {B, 10}, {B, 11}, {B, 12}, {B, 13}, {B, 14}, {B, 15},  // AN8
    {C, 1}, {C, 2}, {C, 3},  {C, 4},  {A, 12}, {A, 13}, {A, 6},  {A, 7},   // AN16
    {E, 0}, {E, 1}, {E, 2},  {E, 3},  {E, 4},  {E, 5},  {E, 6},  {E, 7},   // AN24
};

constexpr TimerPlace kTimers[] = {
    {1, {sfr::TMR1, sfr::PR1, sfr::T1CON, irq::T1, 0, true}, {C, 14}},
    {3, {sfr::TMR3, sfr::PR3, sfr::T3CON, irq::T3}, {C, 2}},
    {2, {sfr::TMR2, sfr::PR2, sfr::T2CON, irq::T2, sfr::TMR3HLD}, {C, 1}},
    {5, {sfr::TMR5, sfr::PR5, sfr::T5CON, irq::T5}, {C, 4}},
    {4, {sfr::TMR4, sfr::PR4, sfr::T4CON, irq::T4, sfr::TMR5HLD}, {C, 3}},
    {7, {sfr::TMR7, sfr::PR7, sfr::T7CON, irq::T7}, {C, 1}},
    {6, {sfr::TMR6, sfr::PR6, sfr::T6CON, irq::T6, sfr::TMR7HLD}, {C, 2}},
    {9, {sfr::TMR9, sfr::PR9, sfr::T9CON, irq::T9}, {C, 3}},
    {8, {sfr::TMR8, sfr::PR8, sfr::T8CON, irq::T8, sfr::TMR9HLD}, {C, 4}},
};

constexpr Uart::Setup kUarts[] = {
    {1, sfr::U1MODE, irq::U1RX, irq::U1TX, F, 2, 3, true, irq::U1E, D, 14, 15},
    {2, sfr::U2MODE, irq::U2RX, irq::U2TX, F, 4, 5, true, irq::U2E, F, 12, 13},
};

constexpr double kI2cFixedHertz = 10'000'000.0;
constexpr I2cMaster::Setup kI2cs[] = {
    {1, sfr::I2C1RCV, true, irq::MI2C1, irq::SI2C1, G, 2, 3, kI2cFixedHertz},
    {2, sfr::I2C2RCV, true, irq::MI2C2, irq::SI2C2, A, 2, 3, kI2cFixedHertz},
};

constexpr Adc33F::Setup kAdcs[] = {
    {sfr::ADC1BUF0, sfr::AD1CON1, sfr::AD1PCFGH, sfr::AD1PCFGL, sfr::AD1CSSH, sfr::AD1CSSL, sfr::AD1CON4,
     irq::AD1, 32},
    {sfr::ADC2BUF0, sfr::AD2CON1, 0, sfr::AD2PCFGL, 0, sfr::AD2CSSL, sfr::AD2CON4, irq::AD2, 16},
};

constexpr Spi::Setup kSpis[] = {
    {1, sfr::SPI1STAT, irq::SPI1, irq::SPI1E, F, 6, 7, 8, {B, 2}, sfr::SPI1CON2, sfr::SPI1BUF},
    {2, sfr::SPI2STAT, irq::SPI2, irq::SPI2E, G, 6, 7, 8, {G, 9}, sfr::SPI2CON2, sfr::SPI2BUF},
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
constexpr Ecan::Setup kEcans[] = {
    {1, sfr::C1CTRL1, irq::C1, irq::C1RX, irq::C1TX, F, 0, 1},
    {2, sfr::C2CTRL1, irq::C2, irq::C2RX, irq::C2TX, G, 0, 1},
};

constexpr Ports::Pin kOcfa{B, 6}, kOcfb{B, 15};

constexpr std::uint16_t kStored[] = {sfr::BSRAM, sfr::SSRAM};

constexpr Layout kLayout = {
    .ports = {kPorts,
              kAnalog,
              {sfr::AD1PCFGL, sfr::AD2PCFGL},
              sfr::AD1PCFGH,
              {sfr::CNEN1, sfr::CNEN2},
              {sfr::CNPU1, sfr::CNPU2},
              irq::CN},
    .external_irqs = {irq::INT0, irq::INT1, irq::INT2, irq::INT3, irq::INT4},
    .timers = kTimers,
    .uarts = kUarts,
    .i2cs = kI2cs,
    .adcs = kAdcs,
    .adc_timers = {3, 5},
    .spis = kSpis,
    .output_compare = {kOutputCompares, {kOcfa, kOcfb}},
    .input_captures = kInputCaptures,
    .ecans = kEcans,
    .dma = {sfr::DMA0CON,
            sfr::DMACS0,
            {irq::DMA0, irq::DMA1, irq::DMA2, irq::DMA3, irq::DMA4, irq::DMA5, irq::DMA6, irq::DMA7},
            0x7800},
    .dci = {sfr::DCICON1, irq::DCI, irq::DCIE, G, 12, 13, 14, 15},
    .stored = kStored,
};

}  // namespace

const Layout& layout_dspic33fj256gp710() {
    return kLayout;
}

const Layout& layout_of(const DeviceInfo& device) {
    return device.family_33f ? layout_dspic33fj256gp710() : layout_dspic30f6014a();
}

}  // namespace puckloop::dspic
