#include "emu/avr/peripherals/eeprom.h"

namespace puckloop::avr {

namespace {
constexpr int kEepromVector = 25;
constexpr std::uint16_t kEecr = 0x3F, kEedr = 0x40, kEearl = 0x41, kEearh = 0x42;
constexpr std::uint8_t kMode = bit(5) | bit(4);  // EEPM, which cannot change while a byte is programmed
constexpr std::uint8_t kEerie = bit(3), kEempe = bit(2), kEepe = bit(1), kEere = bit(0);
constexpr std::uint8_t kErasedByte = 0xFF;
constexpr Cycle kEempeArmed = 4, kReadHalt = 4, kWriteHalt = 2;
/// Seconds, by EEPM1:0: erase and write, erase only, write only.
constexpr double kSeconds[] = {3.4e-3, 1.8e-3, 1.8e-3, 1.8e-3};
enum EepromMode : unsigned { kEraseAndWrite, kEraseOnly, kWriteOnly };
}  // namespace

Eeprom::Eeprom(const Surroundings& around, Core& core, const cosim::ClockDomain& clock, std::size_t bytes)
    : around_(around),
      core_(core),
      clock_(clock),
      bytes_(bytes, kErasedByte),
      slot_(around.events.add(this, &due)) {
    around_.io.hook(kEecr, this, &read_control, &write_control);
    around_.io.hook_quiet(kEecr, &read_control);
    for (const std::uint16_t address : {kEedr, kEearl, kEearh})
        around_.io.claim(address);
    around_.interrupts.connect(kEepromVector, this, nullptr);
}

void Eeprom::reset() {
    state_ = {};
    around_.events.cancel(slot_);
}

void Eeprom::rate_changes(bool changed) {
    const Cycle due = around_.events.due(slot_);
    if (due == kNoCycle) return;
    if (!changed) {
        kept_ = clock_.time_of(due);
        return;
    }
    state_.busy_until = clock_.first_cycle_at(kept_);
    around_.events.schedule(slot_, state_.busy_until);
}

std::size_t Eeprom::address() const {
    return static_cast<std::size_t>(around_.io.raw(kEearh) << 8 | around_.io.raw(kEearl)) % bytes_.size();
}

// EE_READY requests as long as nothing is being programmed.
void Eeprom::update_request(Cycle now) {
    around_.interrupts.request(kEepromVector, (around_.io.raw(kEecr) & kEerie) && now >= state_.busy_until);
}

std::uint8_t Eeprom::read_control(void* owner, std::uint16_t address) {
    const auto& self = *static_cast<Eeprom*>(owner);
    std::uint8_t value = self.around_.io.raw(address);
    assign(value, kEempe, self.around_.now < self.state_.armed_until);
    assign(value, kEepe, self.busy());
    return value;
}

void Eeprom::write_control(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Eeprom*>(owner);
    const auto written = static_cast<std::uint8_t>(value & mask);
    const bool armed = self.around_.now < self.state_.armed_until;
    constexpr std::uint8_t kActions = kEempe | kEepe | kEere;
    const auto fixed = static_cast<std::uint8_t>(kActions | (self.busy() ? kMode : 0));
    self.around_.io.store(address, value, mask & static_cast<std::uint8_t>(~fixed));
    if ((written & kEepe) && armed && !self.busy()) {
        self.program();
    } else if (written & kEempe) {
        self.state_.armed_until = self.around_.now + 1 + kEempeArmed;
    } else if ((written & kEere) && !self.busy()) {
        self.around_.io.raw(kEedr) = self.bytes_[self.address()];
        self.core_.stall_until(self.around_.now + 1 + kReadHalt);
    }
    self.update_request(self.around_.now);
}

void Eeprom::program() {
    const unsigned mode = field(around_.io.raw(kEecr), 5, 4);
    std::uint8_t& cell = bytes_[address()];
    undo_.note(static_cast<std::uint32_t>(address()), cell);
    const std::uint8_t data = around_.io.raw(kEedr);
    cell = mode == kEraseOnly   ? kErasedByte
           : mode == kWriteOnly ? static_cast<std::uint8_t>(cell & data)
                                : data;
    state_.armed_until = 0;
    state_.busy_until = around_.now + static_cast<Cycle>(kSeconds[mode] * clock_.hertz());
    around_.events.schedule(slot_, state_.busy_until);
    core_.stall_until(around_.now + 1 + kWriteHalt);
}

void Eeprom::due(void* owner, Cycle cycle) {
    static_cast<Eeprom*>(owner)->update_request(cycle);
}

}  // namespace puckloop::avr
