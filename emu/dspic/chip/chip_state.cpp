// What a dsPIC remembers: saved, loaded, and gone back to.

#include "emu/dspic/chip/chip_parts.h"
#include "emu/dspic/peripherals/timing/oscillator_33f.h"

#include "base/states/archive.h"
#include "base/states/checkpoint.h"

namespace puckloop::dspic {

using cosim::Time;

namespace {

constexpr Cycle later_cycle(Cycle cycle, Cycle by) {
    return cycle > kNoCycle - by ? kNoCycle : cycle + by;
}

}  // namespace

template <class Archive>
void Chip::Parts::check_report(Archive& archive) const {
    const auto check_text = [&](const auto& records, auto text) {
        for (const auto& record : records)
            for (const char c : record.*text)
                archive.check(c >= ' ' && c <= '~', "a record that is no text");
    };
    check_text(report.resets, &ResetRecord::cause);
    check_text(report.traps, &TrapRecord::name);
    check_text(report.unmodelled, &UnmodelledTouch::name);
    check_text(report.warnings, &ChipWarning::text);
}

template <class Archive>
void Chip::Parts::check_times(Archive& archive) const {
    // An instruction is never cut in two, so the core may be somewhat ahead.
    constexpr Cycle kMostAhead = 1000;
    constexpr Time kAhead = 100 * cosim::kMillisecond;  // a CPU that dozes: cycles 128 times as long
    const Time reached = clock.time_of(core.cycle());
    archive.check(reached >= now && reached - now <= kAhead, "core and clock at different times");
    archive.check(later_cycle(events.next(), kMostAhead) >= core.cycle(), "an event long overdue");
}

template <class Archive>
void Chip::Parts::state(Archive& archive) {
    if constexpr (!Archive::kRaw) {
        std::string part(device.name);
        archive(part);
        archive.check(part == device.name, "a state of another chip");
    }
    archive.part("clock", clock);
    archive.part("registers", sfr);
    if constexpr (Archive::kLoads) disable->restore();
    archive.part("core", core);
    if (device.family_33f)
        archive.part("oscillator", static_cast<Oscillator33F&>(*oscillator));
    else
        archive.part("oscillator", static_cast<Oscillator&>(*oscillator));
    archive.part("ports", ports);
    if constexpr (Archive::kLoads) interrupts.forget_rests();
    if constexpr (!Archive::kRaw && !Archive::kLoads)  // what rests is nobody's business
        if (const Cycle cycle = message_cycle(); cycle > 0)
            for (Timer& timer : timers)
                timer.wake(cycle - 1);
    const auto parts_of = [&](const char* name, auto& modules) {
        for (std::size_t i = 0; i < modules.size(); ++i)
            archive.part(name, i + 1, modules[i]);
    };
    parts_of("timer", timers);
    parts_of("uart", uarts);
    if (adc12) archive.part("adc", *adc12);
    parts_of("i2c", masters);
    parts_of("i2c slave", slaves);
    parts_of("adc", adcs);
    parts_of("spi", spis);
    archive.part("output compare", *output_compare);
    archive.part("input capture", *input_capture);
    if (dma) archive.part("dma", *dma);
    if (dci) archive.part("dci", *dci);
    if (low_voltage) archive.part("low voltage", *low_voltage);
    parts_of("can", cans);
    parts_of("ecan", ecans);
    archive.part("report", report);
    archive(asleep_since);
    if constexpr (Archive::kLoads) holding = true;
    if constexpr (!Archive::kRaw) check_report(archive);
    archive.part("held interrupts", held);
    archive.part("supply", supply);
    archive.part("events", events);
    if constexpr (Archive::kLoads)
        for (Timer& timer : timers)
            timer.loaded();
    archive.bounded(now, 0, cosim::kNever);
    if constexpr (!Archive::kRaw) check_times(archive);
}
void Chip::state(StateWriter& archive) const {
    parts_->state(archive);
}

void Chip::state(StateReader& archive) {
    parts_->state(archive);
    parts_->interrupts.registers_loaded();
    parts_->stopped_at.reset();
}

void Chip::state(CheckpointWriter& archive) const {
    parts_->state(archive);
}

void Chip::state(CheckpointReader& archive) {
    parts_->state(archive);
    parts_->interrupts.registers_loaded();
}

void Chip::mark() {
    parts_->core.mark();
}

void Chip::rewind() {
    parts_->core.rewind();
}

void Chip::settle() {
    parts_->core.settle();
}

}  // namespace puckloop::dspic
