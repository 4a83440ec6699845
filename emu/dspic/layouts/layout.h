#pragma once
// Which modules a part has, and where: their registers, interrupt numbers and pins. One layout a device; the
// chip is wired from it (chip.cpp). See emu/dspic/devices/.

#include "emu/dspic/devices/device.h"
#include "emu/dspic/peripherals/adc_33f.h"
#include "emu/dspic/peripherals/can/can.h"
#include "emu/dspic/peripherals/can/ecan.h"
#include "emu/dspic/peripherals/dma.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/serial/dci.h"
#include "emu/dspic/peripherals/serial/i2c_master.h"
#include "emu/dspic/peripherals/serial/spi.h"
#include "emu/dspic/peripherals/serial/uart.h"
#include "emu/dspic/peripherals/timing/input_capture.h"
#include "emu/dspic/peripherals/timing/output_compare.h"
#include "emu/dspic/peripherals/timing/timer.h"

#include <array>
#include <cstdint>
#include <span>

namespace puckloop::dspic {

/// A timer and its clock pin TxCK. `number` is the data sheet's.
struct TimerPlace {
    int number = 0;
    Timer::Setup setup;
    Ports::Pin clock;
};

struct Layout {
    Ports::Setup ports;
    std::array<std::uint8_t, 5> external_irqs{};  ///< INT0..INT4
    /// Of a pair the upper timer stands directly before its lower one.
    std::span<const TimerPlace> timers;
    std::span<const Uart::Setup> uarts;
    std::span<const I2cMaster::Setup> i2cs;
    bool adc12 = false;                     ///< the 30F's converter
    std::span<const Adc33F::Setup> adcs{};  ///< the 33FJ's
    std::array<int, 2> adc_timers{};        ///< numbers of the timers that can start each converter
    std::span<const Spi::Setup> spis{};
    OutputCompare::Setup output_compare{};
    std::span<const InputCapture::Unit> input_captures{};
    std::span<const Can::Setup> cans{};    ///< the 30F's
    std::span<const Ecan::Setup> ecans{};  ///< the 33FJ's
    Dma::Setup dma{};
    Dci::Setup dci{};
    std::uint8_t low_voltage_irq = 0;         ///< 0: the part has no low-voltage detector
    std::span<const std::uint16_t> stored{};  ///< registers that hold what is written and do no more
};

const Layout& layout_of(const DeviceInfo& device);
const Layout& layout_dspic30f6014a();
const Layout& layout_dspic33fj256gp710();

}  // namespace puckloop::dspic
