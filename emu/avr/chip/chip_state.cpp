// What an ATmega1284P remembers: saved, loaded, and gone back to.

#include "emu/avr/chip/chip_parts.h"

#include "base/states/archive.h"
#include "base/states/checkpoint.h"

namespace puckloop::avr {

template <class Archive>
void Chip::Parts::state(Archive& archive) {
    if constexpr (!Archive::kRaw) {
        std::string part(device.name);
        archive(part);
        archive.check(part == device.name, "a state of another chip");
    }
    archive.part("clock", clock);
    archive.part("registers", io);
    archive.part("timetable", events);
    archive.part("core", core);
    archive.part("interrupts", interrupts);
    archive.part("fuses", fuses);
    archive.part("system", system);
    archive.part("prescaler", synchronous);
    archive.part("prescaler2", asynchronous);
    archive.part("watch", watch);
    archive.part("ports", ports);
    archive.part("timer0", timer0);
    archive.part("timer1", timer1);
    archive.part("timer2", timer2);
    archive.part("timer3", timer3);
    archive.part("usart0", usart0);
    archive.part("usart1", usart1);
    archive.part("twi", twi);
    archive.part("spi", spi);
    archive.part("adc", adc);
    archive.part("eeprom", eeprom);
    archive.part("watchdog", watchdog);
    archive.part("programming", programming);
    archive.part("held interrupts", held);
    archive.bounded(now, 0, cosim::kNever);
    archive.part("supply", supply);
    if constexpr (Archive::kLoads) {
        adc.set_avcc(supply.volts());
        watch_triggers(false);
    }
    if constexpr (Archive::kRaw)
        archive.grows(report.resets, report.unmodelled, report.warnings);
    else
        archive(report.resets, report.unmodelled, report.warnings);
}

void Chip::state(StateWriter& archive) const {
    parts_->state(archive);
}
void Chip::state(StateReader& archive) {
    parts_->state(archive);
    parts_->stopped = false;
}
void Chip::state(CheckpointWriter& archive) const {
    parts_->state(archive);
}
void Chip::state(CheckpointReader& archive) {
    parts_->state(archive);
    parts_->stopped = false;
}

void Chip::mark() {
    parts_->core.mark();
    parts_->eeprom.mark();
}
void Chip::rewind() {
    parts_->core.rewind();
    parts_->eeprom.rewind();
}
void Chip::settle() {
    parts_->core.settle();
    parts_->eeprom.settle();
}

}  // namespace puckloop::avr
