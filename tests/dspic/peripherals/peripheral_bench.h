#pragma once
// A chip without a CPU: registers, timetable and interrupt flags for a peripheral under test, driven cycle
// by cycle.

#include "cosim/core/clock.h"
#include "emu/dspic/devices/device.h"
#include "emu/dspic/devices/dspic30f6014a_irq.h"
#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/layouts/layout.h"
#include "emu/dspic/machine/interrupts.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/surroundings.h"

#include <array>
#include <map>
#include <vector>

namespace puckloop::dspic::test {

/// Remembers what the chip does at its pins and plays what the test sets.
struct FakePins : Pins {
    struct Drive {
        PortLetter port;
        std::uint16_t levels;
        std::uint16_t driven;
        Cycle at;
    };
    struct Sample {
        int channel;
        Cycle at;
    };

    void driven(PortLetter port, std::uint16_t levels, std::uint16_t driven, Cycle now) override {
        drives.push_back({port, levels, driven, now});
    }
    std::uint16_t levels(PortLetter port, Cycle) override { return outside[port]; }
    double analog(int channel, Cycle now) override {
        samples.push_back({channel, now});
        return volts[static_cast<std::size_t>(channel)];
    }
    void uart_sent(int, const cosim::UartFrame& frame) override { frames.push_back(frame); }
    void i2c_phase(int, const cosim::I2cPhase& phase) override { phases.push_back(phase); }

    std::map<PortLetter, std::uint16_t> outside;
    std::array<double, 32> volts{};
    std::vector<Drive> drives;
    std::vector<Sample> samples;
    std::vector<cosim::UartFrame> frames;
    std::vector<cosim::I2cPhase> phases;
};

inline constexpr double kFcy = 14'745'600.0;

struct Bench {
    SfrSpace sfr;
    EventQueue events;
    Cycle now = 0;
    Cycle disi_end = 0;
    InterruptController interrupts;
    Surroundings around{sfr, events, now, interrupts};
    cosim::ClockDomain clock{kFcy};
    FakePins pins;

    explicit Bench(const DeviceInfo& device = dspic30f6014a())
        : interrupts(device, (sfr.describe(device.registers), sfr)) {
        interrupts.set_clock(&now, &disi_end);
        interrupts.reset();
    }

    /// Lets events happen up to and including cycle `cycle`, and stands there.
    void go(Cycle cycle) {
        while (events.next() <= cycle) {
            now = events.next();
            events.service(now);
        }
        now = cycle;
    }
    void write(std::uint16_t address, std::uint16_t value) { sfr.write(address, value, 0xFFFF); }
    std::uint16_t read(std::uint16_t address) { return sfr.read(address); }
    bool flag(int irq) const { return interrupts.flag(irq); }
    /// True once, if the flag was set.
    bool take(int irq) {
        const bool was = interrupts.flag(irq);
        if (was) interrupts.clear(irq);
        return was;
    }
    /// Goes on until the flag is set and returns that cycle; kNoCycle if it does not happen by `last`.
    Cycle until_flag(int irq, Cycle last) {
        while (!interrupts.flag(irq)) {
            if (events.next() > last) return kNoCycle;
            go(events.next());
        }
        interrupts.clear(irq);
        return now;
    }
};

}  // namespace puckloop::dspic::test
