#pragma once
// The modules of a dsPIC, as chip.h's class has them inside: for that class's own files only.

#include "emu/dspic/chip/chip.h"
#include "emu/dspic/chip/module_disable.h"
#include "emu/dspic/chip/supply_reset.h"
#include "emu/dspic/core/core.h"
#include "emu/dspic/layouts/layout.h"
#include "emu/dspic/machine/interrupts.h"
#include "emu/dspic/peripherals/adc12.h"
#include "emu/dspic/peripherals/external_interrupts.h"
#include "emu/dspic/peripherals/low_voltage.h"
#include "emu/dspic/peripherals/serial/dci.h"
#include "emu/dspic/peripherals/serial/i2c_slave.h"
#include "emu/dspic/peripherals/timing/oscillator.h"
#include "emu/image/code_places.h"

#include <deque>
#include <memory>
#include <optional>
#include <vector>

namespace puckloop::dspic {

/// The schematic of the part.
struct Chip::Parts {
    const DeviceInfo& device;
    const Layout& layout;
    Pins& pins;
    ChipOptions options;
    cosim::ClockDomain clock;
    SfrSpace sfr;
    EventQueue events;
    InterruptController interrupts;
    Core core;
    Surroundings around;
    std::unique_ptr<ClockControl> oscillator;
    Ports ports;
    ExternalInterrupts external;
    std::deque<Timer> timers;  ///< in the layout's order
    std::deque<Uart> uarts;
    std::optional<Adc12> adc12;
    std::deque<I2cMaster> masters;
    std::deque<I2cSlave> slaves;
    std::deque<Adc33F> adcs;
    std::deque<Spi> spis;
    std::optional<OutputCompare> output_compare;
    std::optional<InputCapture> input_capture;
    std::optional<Dma> dma;
    std::optional<Dci> dci;
    std::optional<LowVoltage> low_voltage;
    std::deque<Can> cans;
    std::deque<Ecan> ecans;
    std::optional<ModuleDisable> disable;
    chip::HeldInterrupts held;
    EventQueue::Slot edges;  ///< that the board makes by itself; behind the others, which keep theirs
    SupplyReset supply;

    ChipReport report;
    image::CodePlaces places;
    std::vector<std::uint32_t> stops;
    std::optional<std::uint32_t> stopped_at;
    cosim::Time now = 0;    ///< the last `until`
    cosim::Time until = 0;  ///< of the run in progress
    cosim::Time pause = cosim::kNever;
    std::optional<Cycle> asleep_since;
    std::uint64_t instructions_run = 0;        ///< what was taken back counts, too
    std::vector<std::uint16_t> idle_controls;  ///< registers with a bit that stops a module in Idle
    bool holding = true;                       ///< set_power() may have stopped a module

    Parts(const DeviceInfo& device_info, Pins& board, const ChipOptions& chip_options);

    // chip_parts.cpp: how it is wired
    SfrSpace& described() {
        sfr.describe(device.registers);
        return sfr;
    }
    std::unique_ptr<ClockControl> make_oscillator();
    void list_idle_controls();
    void wire();
    void plan_edges(Cycle after) { events.schedule(edges, ports.next_edge(after)); }
    /// By the data sheet's number; null if the part has no such timer.
    Timer* timer(int number);

    // chip_power.cpp: what resets, supply and power modes do to it
    void supply_changed();
    ClockConfiguration clock_words() const;
    /// Registers and modules at a reset; the core does its own and RCON.
    void reset(ResetCause cause);
    /// Sleep stops every module that needs the instruction clock, Idle those whose xSIDL bit is set.
    void set_power(PowerMode mode);

    Uart& uart(int unit) { return uarts[static_cast<std::size_t>(unit - 1)]; }

    /// The cycle that messages handed in now belong to: the first that starts at or after the last `until`.
    Cycle message_cycle() const { return clock.first_cycle_at(now); }
    Cycle until_cycle() const { return clock.first_cycle_at(until); }
    /// Run up to `time`: the outside may change from there on.
    void arrive(cosim::Time time);

    // chip_state.cpp
    /// What the part remembers, once for saving and loading. Registers come first: modules look at them.
    template <class Archive>
    void state(Archive& archive);
    template <class Archive>
    void check_report(Archive& archive) const;
    template <class Archive>
    void check_times(Archive& archive) const;
};

}  // namespace puckloop::dspic
