#include "emu/dspic/peripherals/ports.h"

#include "emu/dspic/devices/dspic30f6014a_irq.h"
#include "emu/dspic/devices/dspic30f6014a_sfr.h"

namespace puckloop::dspic {

namespace {

// CN0..CN23 of the 80-pin parts.
struct ChangePin {
    PortLetter port;
    int pin;
};
using enum PortLetter;
constexpr ChangePin kChangePins[] = {
    {C, 14}, {C, 13}, {B, 0}, {B, 1}, {B, 2}, {B, 3}, {B, 4}, {B, 5},  {G, 6},  {G, 7},  {G, 8}, {G, 9},
    {B, 15}, {D, 4},  {D, 5}, {D, 6}, {D, 7}, {F, 4}, {F, 5}, {D, 13}, {D, 14}, {D, 15}, {A, 6}, {A, 7},
};

}  // namespace

Ports::Ports(const Surroundings& around, Pins& pins) : around_(around), pins_(pins) {
    const struct {
        PortLetter letter;
        std::uint16_t tris, port, lat;
    } map[] = {
        {A, sfr::TRISA, sfr::PORTA, sfr::LATA}, {B, sfr::TRISB, sfr::PORTB, sfr::LATB},
        {C, sfr::TRISC, sfr::PORTC, sfr::LATC}, {D, sfr::TRISD, sfr::PORTD, sfr::LATD},
        {F, sfr::TRISF, sfr::PORTF, sfr::LATF}, {G, sfr::TRISG, sfr::PORTG, sfr::LATG},
    };
    for (const auto& entry : map) {
        Port& port = at(entry.letter);
        port.tris = entry.tris;
        port.port = entry.port;
        port.lat = entry.lat;
        port.implemented = around_.sfr.info(entry.tris)->implemented;
        around_.sfr.hook(entry.tris, this, nullptr, write_tris);
        around_.sfr.hook(entry.port, this, read_port, write_port);
        around_.sfr.hook(entry.lat, this, nullptr, write_port);
    }
    for (const std::uint16_t address : {sfr::CNEN1, sfr::CNEN2})
        around_.sfr.hook(address, this, nullptr, write_cn);
    for (const std::uint16_t address : {sfr::CNPU1, sfr::CNPU2})
        around_.sfr.claim(address);
}

int Ports::index_of(std::uint16_t address) const {
    for (int i = 0; i < kPorts; ++i) {
        const Port& port = ports_[static_cast<std::size_t>(i)];
        if (port.tris == address || port.port == address || port.lat == address) return i;
    }
    return 0;
}

void Ports::reset() {
    for (int i = 0; i < kPorts; ++i) {
        Port& port = ports_[static_cast<std::size_t>(i)];
        if (!port.tris) continue;
        port.lent = 0;
        drive(i, around_.now);
        port.noticed = pin_levels(i, around_.now);
        port.seen = static_cast<std::uint16_t>(port.noticed & port.watched);
    }
    for (const Watcher& watcher : watchers_)
        watcher.changed(watcher.owner, at(watcher.port).seen & watcher.mask, kNoCycle);
}

// What the input buffers see, analog pins included.
std::uint16_t Ports::pin_levels(int index, Cycle now) const {
    const Port& port = ports_[static_cast<std::size_t>(index)];
    const std::uint16_t outside =
        port.driven == port.implemented ? 0 : pins_.levels(static_cast<PortLetter>(index), now);
    return static_cast<std::uint16_t>(((outside & ~port.driven) | (port.levels & port.driven)) &
                                      port.implemented);
}

bool Ports::level(PortLetter port, int pin) const {
    return pin_levels(static_cast<int>(port), around_.now) >> pin & 1;
}

// Tells the board what the drivers do, if that changed.
void Ports::drive(int index, Cycle when) {
    Port& port = ports_[static_cast<std::size_t>(index)];
    const unsigned own = static_cast<unsigned>(~around_.sfr.raw(port.tris) & port.implemented & ~port.lent);
    const auto driven = static_cast<std::uint16_t>(own | (port.lent & port.lent_output));
    const auto levels =
        static_cast<std::uint16_t>((around_.sfr.raw(port.lat) & own) | (port.lent_levels & driven & ~own));
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
    if (changed & (levels ^ port.noticed) & change_enabled(index)) around_.interrupts.raise(irq::CN, when);
}

std::uint16_t Ports::change_enabled(int index) const {
    std::uint32_t enabled =
        around_.sfr.raw(sfr::CNEN1) | static_cast<std::uint32_t>(around_.sfr.raw(sfr::CNEN2)) << 16;
    std::uint16_t mask = 0;
    for (const ChangePin& pin : kChangePins) {
        if ((enabled & 1u) && static_cast<int>(pin.port) == index) mask |= bit(pin.pin);
        enabled >>= 1;
    }
    return mask;
}

void Ports::outside_changed(PortLetter port, Cycle when) {
    if (at(port).watched) look(static_cast<int>(port), when);
}

void Ports::lend(PortLetter letter, std::uint16_t mask, std::uint16_t output, std::uint16_t levels) {
    announce();
    Port& port = at(letter);
    port.lent |= mask;
    port.lent_output = static_cast<std::uint16_t>((port.lent_output & ~mask) | (output & mask));
    port.lent_levels = static_cast<std::uint16_t>((port.lent_levels & ~mask) | (levels & mask));
    drive(static_cast<int>(letter), around_.now + 1);
}

void Ports::give_back(PortLetter letter, std::uint16_t mask) {
    announce();
    Port& port = at(letter);
    port.lent = static_cast<std::uint16_t>(port.lent & ~mask);
    drive(static_cast<int>(letter), around_.now + 1);
}

void Ports::watch(PortLetter letter, int pin, void* owner, void (*changed)(void*, bool, Cycle)) {
    at(letter).watched |= bit(pin);
    watchers_.push_back({letter, bit(pin), owner, changed});
}

void Ports::refresh() {
    for (int i = 0; i < kPorts; ++i) {
        const Port& port = ports_[static_cast<std::size_t>(i)];
        if (!port.tris) continue;
        std::uint16_t levels = pin_levels(i, around_.now);
        if (static_cast<PortLetter>(i) == B) levels &= around_.sfr.raw(sfr::ADPCFG);
        around_.sfr.raw(port.port) = levels;
    }
}

std::uint16_t Ports::read_port(void* owner, std::uint16_t address) {
    Ports& self = *static_cast<Ports*>(owner);
    const int index = self.index_of(address);
    const std::uint16_t levels = self.pin_levels(index, self.around_.now);
    self.ports_[static_cast<std::size_t>(index)].noticed = levels;
    // The digital input buffer of an analog pin is off.
    return index == static_cast<int>(B) ? levels & self.around_.sfr.raw(sfr::ADPCFG) : levels;
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
    std::uint32_t enabled =
        self.around_.sfr.raw(sfr::CNEN1) | static_cast<std::uint32_t>(self.around_.sfr.raw(sfr::CNEN2)) << 16;
    for (const ChangePin& pin : kChangePins) {
        if (enabled & 1u) {
            Port& port = self.at(pin.port);
            if (!(port.watched & bit(pin.pin))) {
                port.watched |= bit(pin.pin);
                port.seen |= static_cast<std::uint16_t>(self.level(pin.port, pin.pin) ? bit(pin.pin) : 0);
            }
        }
        enabled >>= 1;
    }
}

}  // namespace puckloop::dspic
