#pragma once
// A bare core for tests: program in assembly, no peripherals but what a test schedules itself.

#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/core/core.h"

#include <string>
#include <vector>

namespace puckloop::dspic::test {

struct Rig {
    const DeviceInfo& device;
    SfrSpace sfr;
    EventQueue events;
    InterruptController interrupts;
    Core core;
    Program program;
    std::vector<std::string> log;  ///< "reset <cause>", "trap <n>", "interrupt <vector>"

    /// Assembles from 0x200 on (labels may be used by .org elsewhere); the reset vector leads there.
    explicit Rig(const std::string& source, const DeviceInfo& part = dspic30f6014a())
        : device(part), interrupts(device, describe()), core(device, sfr, events, interrupts) {
        program = assemble("        goto 0x200\n        .org 0x200\n" + source);
        for (const auto& [address, word] : program.words)
            core.poke_program(address, word);
        core.set_reset_hook([this](ResetCause) { sfr.reset_values(); });
        core.observer().on_reset = [this](ResetCause cause, std::uint32_t, Cycle) {
            log.push_back("reset " + std::string(to_string(cause)));
        };
        core.observer().on_trap = [this](Trap trap, std::uint32_t, Cycle) {
            log.push_back("trap " + std::string(device.vector_name(static_cast<int>(trap))));
        };
        core.observer().on_interrupt = [this](int vector, std::uint32_t, Cycle) {
            log.push_back("interrupt " + std::string(device.vector_name(vector)));
        };
        core.reset(ResetCause::PowerOn);
        log.clear();
        const std::uint32_t start[] = {0x200};
        core.set_stops(start);
        core.run(100);
        core.set_stops({});
    }

    SfrSpace& describe() {
        sfr.describe(device.registers);
        return sfr;
    }
    /// Entry `vector` of the interrupt table leads to `handler`, in both tables if they differ only in place.
    void vector(int number, const std::string& handler, bool alternate = false) {
        const std::uint32_t table = alternate ? device.aivt : device.ivt;
        core.poke_program(table + 2u * static_cast<std::uint32_t>(number), program.symbol(handler));
    }
    /// Runs to the label; false if it is not reached within `cycles`.
    bool run_to(const std::string& label, Cycle cycles = 100'000) {
        const std::uint32_t at[] = {program.symbol(label)};
        core.set_stops(at);
        const bool reached = core.run(core.cycle() + cycles) == Core::Outcome::Stopped;
        core.set_stops({});
        return reached;
    }
    /// Cycles from here to the label.
    Cycle cycles_to(const std::string& label) {
        const Cycle start = core.cycle();
        return run_to(label) ? core.cycle() - start : kNoCycle;
    }
    std::uint16_t w(int index) const { return core.w(index); }
    std::uint16_t data(std::uint16_t address) { return core.read_data(address); }
};

/// An event that raises an interrupt at a cycle.
struct Raiser {
    Rig& rig;
    int irq;
    EventQueue::Slot slot;
    Raiser(Rig& owner, int number) : rig(owner), irq(number), slot(owner.events.add(this, &fire)) {}
    void at(Cycle cycle) { rig.events.schedule(slot, cycle); }
    static void fire(void* self, Cycle due) {
        auto& raiser = *static_cast<Raiser*>(self);
        raiser.rig.interrupts.raise(raiser.irq, due);
    }
};

}  // namespace puckloop::dspic::test
