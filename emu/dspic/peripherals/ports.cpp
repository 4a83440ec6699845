#include "emu/dspic/peripherals/ports.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

// CN0..CN23 of the 80-pin and 100-pin parts.
using enum PortLetter;
constexpr Ports::Pin kChangePins[] = {
    {C, 14}, {C, 13}, {B, 0}, {B, 1}, {B, 2}, {B, 3}, {B, 4}, {B, 5},  {G, 6},  {G, 7},  {G, 8}, {G, 9},
    {B, 15}, {D, 4},  {D, 5}, {D, 6}, {D, 7}, {F, 4}, {F, 5}, {D, 13}, {D, 14}, {D, 15}, {A, 6}, {A, 7},
};

}  // namespace

Ports::Ports(const Surroundings& around, const Setup& setup, Pins& pins)
    : around_(around), setup_(setup), pins_(pins) {
    for (const Place& place : setup_.ports) {
        Port& port = at(place.letter);
        port.tris = place.tris;
        port.port = place.port;
        port.lat = place.lat;
        port.odc = place.odc;
        port.implemented = around_.sfr.info(place.tris)->implemented;
        for (const std::uint16_t address : {place.tris, place.port, place.lat, place.odc})
            if (address) places_[address >> 1] = static_cast<std::uint8_t>(place.letter);
        around_.sfr.hook(place.tris, this, nullptr, write_tris);
        around_.sfr.hook(place.port, this, read_port, write_port);
        around_.sfr.hook_quiet(place.port, this, look_at_port);
        around_.sfr.hook(place.lat, this, nullptr, write_port);
        if (place.odc) around_.sfr.hook(place.odc, this, nullptr, write_tris);
    }
    for (const Pin& pin : setup_.analog)
        at(pin.port).analog |= bit(pin.number);
    for (const std::uint16_t address : setup_.cnen)
        around_.sfr.hook(address, this, nullptr, write_cn);
    for (const std::uint16_t address : setup_.cnpu)
        around_.sfr.claim(address);
}

void Ports::reset() {
    for (int i = 0; i < kPorts; ++i) {
        Port& port = ports_[static_cast<std::size_t>(i)];
        if (!port.tris) continue;
        port.taken_over = 0;
        drive(i, around_.now);
        port.noticed = pin_levels(i, around_.now);
        port.seen = static_cast<std::uint16_t>(port.noticed & port.watched);
    }
    for (const Watcher& watcher : watchers_)
        watcher.changed(watcher.owner, at(watcher.port).seen & watcher.mask, kNoCycle);
}

// What a board changes by itself is looked at only while somebody monitors it, so a pin that was not
// monitored may be at another level than when it was last seen: that is no edge.
void Ports::monitoring_changed() {
    std::array<std::uint16_t, kPorts> monitored{};
    for (const Watcher& watcher : watchers_)
        if (!watcher.monitors || watcher.monitors(watcher.owner))
            monitored[static_cast<std::size_t>(watcher.port)] |= watcher.mask;
    bool other = false;
    for (int i = 0; i < kPorts; ++i) {
        Port& port = ports_[static_cast<std::size_t>(i)];
        const auto now = static_cast<std::uint16_t>(
            (monitored[static_cast<std::size_t>(i)] | change_enabled(i)) & port.watched);
        if (now == port.monitored) continue;
        const auto fresh = static_cast<std::uint16_t>(now & ~port.monitored);
        port.monitored = now;
        other = true;
        const auto moved = static_cast<std::uint16_t>((pin_levels(i, around_.now) ^ port.seen) & fresh);
        if (!moved) continue;
        port.seen ^= moved;
        for (const Watcher& watcher : watchers_)
            if (static_cast<int>(watcher.port) == i && (moved & watcher.mask))
                watcher.changed(watcher.owner, port.seen & watcher.mask, kNoCycle);
    }
    if (other && on_monitoring) on_monitoring(on_monitoring_owner, around_.now);
}

Cycle Ports::next_edge(Cycle after) const {
    Cycle next = kNoCycle;
    for (int i = 0; i < kPorts; ++i)
        if (const std::uint16_t monitored = ports_[static_cast<std::size_t>(i)].monitored)
            next = std::min(next, pins_.next_edge(static_cast<PortLetter>(i), monitored, after));
    return next;
}

void Ports::sample_monitored(Cycle at) {
    for (int i = 0; i < kPorts; ++i)
        if (ports_[static_cast<std::size_t>(i)].monitored) look(i, at);
}

// What the input buffers see, analog pins included.
std::uint16_t Ports::pin_levels(int index, Cycle now) const {
    const Port& port = ports_[static_cast<std::size_t>(index)];
    const std::uint16_t outside =
        port.driven == port.implemented ? 0 : pins_.levels(static_cast<PortLetter>(index), now);
    return seen_by_buffers(port, outside);
}

std::uint16_t Ports::quiet_levels(int index) const {
    return seen_by_buffers(ports_[static_cast<std::size_t>(index)],
                           pins_.quiet_levels(static_cast<PortLetter>(index), around_.now));
}

std::uint16_t Ports::seen_by_buffers(const Port& port, std::uint16_t outside) {
    return static_cast<std::uint16_t>(((outside & ~port.driven) | (port.levels & port.driven)) &
                                      port.implemented);
}

bool Ports::level(PortLetter port, int pin) const {
    return pin_levels(static_cast<int>(port), around_.now) >> pin & 1;
}

// Notifies the board of what the drivers do, if that changed.
void Ports::drive(int index, Cycle when) {
    Port& port = ports_[static_cast<std::size_t>(index)];
    const unsigned own =
        static_cast<unsigned>(~around_.sfr.raw(port.tris) & port.implemented & ~port.taken_over);
    const std::uint16_t lat = around_.sfr.raw(port.lat);
    // An open-drain output only pulls down.
    const unsigned released = port.odc ? around_.sfr.raw(port.odc) & lat : 0u;
    const auto driven =
        static_cast<std::uint16_t>((own & ~released) | (port.taken_over & port.taken_over_output));
    const auto levels =
        static_cast<std::uint16_t>((lat & own & driven) | (port.taken_over_levels & driven & ~own));
    if (driven == port.driven && levels == port.levels) return;
    port.driven = driven;
    port.levels = levels;
    pins_.driven(static_cast<PortLetter>(index), levels, driven, when);
    if (port.watched) look(index, when);
}

// Edges on watched pins, and change notification.
void Ports::look(int index, Cycle when) {
    Port& port = ports_[static_cast<std::size_t>(index)];
    const std::uint16_t levels = pin_levels(index, when);
    const auto changed = static_cast<std::uint16_t>((levels ^ port.seen) & port.watched);
    if (!changed) return;
    port.seen = static_cast<std::uint16_t>(levels & port.watched);
    for (const Watcher& watcher : watchers_)
        if (static_cast<int>(watcher.port) == index && (changed & watcher.mask))
            watcher.changed(watcher.owner, levels & watcher.mask, when);
    if (changed & (levels ^ port.noticed) & change_enabled(index))
        around_.interrupts.raise(setup_.change_irq, when);
}

std::uint16_t Ports::change_enabled(int index) const {
    std::uint32_t enabled =
        around_.sfr.raw(setup_.cnen[0]) | static_cast<std::uint32_t>(around_.sfr.raw(setup_.cnen[1])) << 16;
    std::uint16_t mask = 0;
    for (const Pin& pin : kChangePins) {
        if ((enabled & 1u) && static_cast<int>(pin.port) == index) mask |= bit(pin.number);
        enabled >>= 1;
    }
    return mask;
}

void Ports::outside_changed(PortLetter port, Cycle when) {
    if (at(port).watched) look(static_cast<int>(port), when);
}

void Ports::take_over(PortLetter letter, std::uint16_t mask, std::uint16_t output, std::uint16_t levels,
                      Cycle when) {
    announce();
    Port& port = at(letter);
    port.taken_over |= mask;
    port.taken_over_output = static_cast<std::uint16_t>((port.taken_over_output & ~mask) | (output & mask));
    port.taken_over_levels = static_cast<std::uint16_t>((port.taken_over_levels & ~mask) | (levels & mask));
    drive(static_cast<int>(letter), when);
}

void Ports::release(PortLetter letter, std::uint16_t mask) {
    announce();
    Port& port = at(letter);
    port.taken_over = static_cast<std::uint16_t>(port.taken_over & ~mask);
    drive(static_cast<int>(letter), around_.now + 1);
}

void Ports::watch(PortLetter letter, int pin, void* owner, void (*changed)(void*, bool, Cycle),
                  bool (*monitors)(const void*)) {
    at(letter).watched |= bit(pin);
    watchers_.push_back({letter, bit(pin), owner, changed, monitors});
}

void Ports::listen(PortLetter letter, int pin, void* owner, void (*changed)(void*, bool, Cycle)) {
    watchers_.push_back({letter, bit(pin), owner, changed, nullptr});
}

void Ports::attend(PortLetter letter, int pin) {
    Port& port = at(letter);
    if (port.watched & bit(pin)) return;
    port.watched |= bit(pin);
    port.seen |= static_cast<std::uint16_t>(level(letter, pin) ? bit(pin) : 0);
    monitoring_changed();
}

bool Ports::digital_level(PortLetter letter, int pin) const {
    const int index = static_cast<int>(letter);
    return (pin_levels(index, around_.now) & digital_pins(index)) >> pin & 1;
}

std::uint32_t Ports::pcfg() const {
    std::uint32_t bits = 0xFFFF'FFFFu;
    for (const std::uint16_t address : setup_.pcfg_low)
        if (address) bits &= 0xFFFF'0000u | around_.sfr.raw(address);
    if (setup_.pcfg_high)
        bits &= 0xFFFFu | static_cast<std::uint32_t>(around_.sfr.raw(setup_.pcfg_high)) << 16;
    return bits;
}

// The digital input buffers of analog pins are off: PORT reads 0 there.
std::uint16_t Ports::digital_pins(int index) const {
    std::uint16_t mask = 0xFFFF;
    if (ports_[static_cast<std::size_t>(index)].analog == 0) return mask;
    const std::uint32_t digital = pcfg();
    for (std::size_t channel = 0; channel < setup_.analog.size(); ++channel) {
        const Pin& pin = setup_.analog[channel];
        if (static_cast<int>(pin.port) == index && !(digital >> channel & 1))
            assign(mask, bit(pin.number), false);
    }
    return mask;
}

bool Ports::digital(int channel) const {
    return pcfg() >> channel & 1;
}

std::optional<bool> Ports::driven_level(int channel) const {
    const Pin& pin = setup_.analog[static_cast<std::size_t>(channel)];
    const Port& port = at(pin.port);
    if (!(port.driven >> pin.number & 1)) return std::nullopt;
    return port.levels >> pin.number & 1;
}

void Ports::refresh() {
    for (int i = 0; i < kPorts; ++i) {
        const Port& port = ports_[static_cast<std::size_t>(i)];
        if (!port.tris) continue;
        around_.sfr.raw(port.port) = quiet_levels(i) & digital_pins(i);
    }
}

std::uint16_t Ports::changeable(PortLetter letter) const {
    const Port& port = at(letter);
    std::uint16_t mask = 0;
    for (int pin = 0; pin < 16; ++pin)
        if ((port.implemented & ~port.driven) >> pin & 1 && pins_.outside(letter, pin).changes)
            mask |= bit(pin);
    return mask;
}

std::uint16_t Ports::look_at_port(void* owner, std::uint16_t address) {
    const Ports& self = *static_cast<const Ports*>(owner);
    const int index = self.index_of(address);
    return self.quiet_levels(index) & self.digital_pins(index);
}

std::uint16_t Ports::read_port(void* owner, std::uint16_t address) {
    Ports& self = *static_cast<Ports*>(owner);
    const int index = self.index_of(address);
    const std::uint16_t levels = self.pin_levels(index, self.around_.now);
    self.ports_[static_cast<std::size_t>(index)].noticed = levels;
    return levels & self.digital_pins(index);
}

void Ports::write_port(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Ports& self = *static_cast<Ports*>(owner);
    const int index = self.index_of(address);
    self.announce();
    self.around_.sfr.store(self.ports_[static_cast<std::size_t>(index)].lat, value, mask);
    self.drive(index, self.around_.now + 1);
}

void Ports::write_tris(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Ports& self = *static_cast<Ports*>(owner);
    self.announce();
    self.around_.sfr.store(address, value, mask);
    self.drive(self.index_of(address), self.around_.now + 1);
}

void Ports::write_cn(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Ports& self = *static_cast<Ports*>(owner);
    self.around_.sfr.store(address, value, mask);
    std::uint32_t enabled = self.around_.sfr.raw(self.setup_.cnen[0]) |
                            static_cast<std::uint32_t>(self.around_.sfr.raw(self.setup_.cnen[1])) << 16;
    for (const Pin& pin : kChangePins) {
        if (enabled & 1u) self.attend(pin.port, pin.number);
        enabled >>= 1;
    }
    self.monitoring_changed();
}

}  // namespace puckloop::dspic
