#include "emu/avr/peripherals/ports.h"

#include "emu/avr/peripherals/shared_registers.h"

namespace puckloop::avr {

namespace {
constexpr std::uint16_t kDidr0 = 0x7E, kDidr1 = 0x7F;
constexpr PortLetter kAll[] = {PortLetter::A, PortLetter::B, PortLetter::C, PortLetter::D};
}  // namespace

Ports::Ports(const Surroundings& around, Pins& pins) : around_(around), pins_(pins) {
    for (std::uint16_t i = 0; i < kPorts; ++i) {
        const auto base = static_cast<std::uint16_t>(kFirst + 3 * i);
        around_.io.hook(base, this, &read_pin, &write_pin);
        around_.io.mark_steady(base);
        around_.io.hook(static_cast<std::uint16_t>(base + kDdr), this, nullptr, &write_output);
        around_.io.hook(static_cast<std::uint16_t>(base + kOutput), this, nullptr, &write_output);
    }
    around_.io.hook(kDidr0, this, nullptr, &write_disable);
    around_.io.hook(kDidr1, this, nullptr, &write_disable);
}

void Ports::reset() {
    for (const PortLetter port : kAll) {
        Port& p = state_[index(port)];
        p.value_mask = {};
        p.direction_mask = p.taken_over = 0;
        drive(port);
    }
}

void Ports::refresh() {
    for (const PortLetter port : kAll)
        drive(port);
}

// The drivers follow the registers and the overrides; then the levels follow the drivers.
void Ports::drive(PortLetter port) {
    Port& p = state_[index(port)];
    const auto driven = static_cast<std::uint8_t>(
        merged(pin_register(port, kDdr), p.directions, p.direction_mask) & ~p.taken_over);
    std::uint8_t values = pin_register(port, kOutput);
    for (std::size_t user = 0; user < p.values.size(); ++user)
        values = merged(values, p.values[user], p.value_mask[user]);
    const auto levels = static_cast<std::uint8_t>(values & driven);
    const bool switched = driven != p.shown_driven;
    if (switched || levels != p.shown_levels) {
        p.shown_driven = driven;
        p.shown_levels = levels;
        pins_.driven(port, levels, driven, around_.now);
    }
    pins_changed(port);
    if (!switched) return;
    for (const HeardDrivers& heard : driver_listeners_)
        heard.call(heard.owner, port);
}

// DIDRn, and whoever needs the pin for something analog: its digital input reads 0.
std::uint8_t Ports::disabled_inputs(PortLetter port) const {
    constexpr int kAin0 = 2;  // PB2 and PB3
    const std::uint8_t taken_over = state_[index(port)].taken_over;
    if (port == PortLetter::A) return taken_over | around_.io.raw(kDidr0);
    if (port == PortLetter::B) return static_cast<std::uint8_t>(taken_over | around_.io.raw(kDidr1) << kAin0);
    return taken_over;
}

void Ports::pins_changed(PortLetter port) {
    Port& p = state_[index(port)];
    const bool disabled = around_.io.raw(kMcucr) & kPud;
    const auto pull_ups =
        static_cast<std::uint8_t>(disabled ? 0 : pin_register(port, kOutput) & ~p.shown_driven);
    const std::uint8_t outside = pins_.levels(port, pull_ups, around_.now);
    const auto now =
        static_cast<std::uint8_t>(merged(outside, p.shown_levels, p.shown_driven) & ~disabled_inputs(port));
    if (now == p.levels) return;
    const std::uint8_t before = p.before = p.levels;
    p.changed = around_.now;
    p.levels = now;
    for (const Heard& heard : listeners_)  // one of them may change the port again
        heard.call(heard.owner, port, before, now, around_.now);
}

void Ports::override_value(Pin pin, bool level, PinUser user) {
    Port& p = state_[index(pin.port)];
    p.value_mask[static_cast<std::size_t>(user)] |= pin.mask();
    assign(p.values[static_cast<std::size_t>(user)], pin.mask(), level);
    drive(pin.port);
}
void Ports::override_direction(Pin pin, bool output) {
    Port& p = state_[index(pin.port)];
    p.direction_mask |= pin.mask();
    assign(p.directions, pin.mask(), output);
    drive(pin.port);
}
void Ports::release_value(Pin pin, PinUser user) {
    assign(state_[index(pin.port)].value_mask[static_cast<std::size_t>(user)], pin.mask(), false);
    drive(pin.port);
}
void Ports::release_direction(Pin pin) {
    assign(state_[index(pin.port)].direction_mask, pin.mask(), false);
    drive(pin.port);
}
void Ports::take_over(PortLetter port, std::uint8_t mask, bool on) {
    assign(state_[index(port)].taken_over, mask, on);
    drive(port);
}

// The synchroniser: an IN right behind the OUT still reads the old level.
std::uint8_t Ports::read_pin(void* owner, std::uint16_t address) {
    const auto& self = *static_cast<Ports*>(owner);
    const Port& p = self.state_[(address - kFirst) / 3u];
    return p.changed != 0 && self.around_.now <= p.changed + 1 ? p.before : p.levels;
}

// Writing a one to PINxn toggles PORTxn.
void Ports::write_pin(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Ports*>(owner);
    const auto port = static_cast<PortLetter>((address - kFirst) / 3);
    self.pin_register(port, kOutput) ^= value & mask;
    self.drive(port);
}

void Ports::write_disable(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Ports*>(owner);
    self.around_.io.store(address, value, mask);
    self.pins_changed(address == kDidr0 ? PortLetter::A : PortLetter::B);
}

void Ports::write_output(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Ports*>(owner);
    self.around_.io.store(address, value, mask);
    self.drive(static_cast<PortLetter>((address - kFirst) / 3));
}

}  // namespace puckloop::avr
