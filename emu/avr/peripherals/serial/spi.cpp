#include "emu/avr/peripherals/serial/spi.h"

#include "emu/avr/peripherals/shared_registers.h"

namespace puckloop::avr {

namespace {
constexpr int kSpiVector = 19;
constexpr std::uint16_t kSpcr = 0x4C, kSpsr = 0x4D, kSpdr = 0x4E;
constexpr std::uint8_t kSpie = bit(7), kSpe = bit(6), kDord = bit(5), kMstr = bit(4), kCpol = bit(3),
                       kCpha = bit(2);                                   // SPCR
constexpr std::uint8_t kSpif = bit(7), kWcol = bit(6), kSpi2x = bit(0);  // SPSR
constexpr std::uint8_t kPrspi = bit(2);                                  // PRR0
constexpr Cycle kDividers[] = {4, 16, 64, 128};                          // SPR1:0
constexpr std::uint8_t kEdges = 16;
constexpr Pin kSs{PortLetter::B, 4}, kMosi{PortLetter::B, 5}, kMiso{PortLetter::B, 6}, kSck{PortLetter::B, 7};
}  // namespace

Spi::Spi(const Surroundings& around, Ports& ports, Pins& pins)
    : around_(around), ports_(ports), pins_(pins), slot_(around.events.add(this, &due)) {
    around_.io.hook(kSpcr, this, nullptr, &write_control);
    around_.io.hook(kSpsr, this, &read_status, &write_status);
    around_.io.hook(kSpdr, this, &read_data, &write_data);
    around_.interrupts.connect(kSpiVector, this, &acknowledge);
    ports_.listen(this, &pins_changed);
    ports_.listen_drivers(this, &drivers_changed);
}

void Spi::reset() {
    state_ = {};
    around_.events.cancel(slot_);
}

bool Spi::on() const {
    return control() & kSpe;
}
bool Spi::master() const {
    return on() && (control() & kMstr);
}
bool Spi::clock_idle() const {
    return control() & kCpol;
}
bool Spi::powered() const {
    return !(around_.io.raw(kPrr0) & kPrspi);
}

void Spi::update_request() {
    around_.interrupts.request(kSpiVector, (status() & kSpif) && (control() & kSpie));
}
void Spi::acknowledge(void* owner, int) {
    auto& self = *static_cast<Spi*>(owner);
    assign(self.status(), kSpif, false);
    self.update_request();
}

void Spi::complete(std::uint8_t received) {
    if (state_.shifting) state_.completed_at = around_.now;
    state_.shifting = false;
    state_.edges = 0;
    state_.received = received;
    status() |= kSpif;
    update_request();
}

// ---- pins

// Who drives what (data sheet, "Overriding Signals for Alternate Functions in PB7:PB4").
void Spi::configure() {
    constexpr PinUser kUser = PinUser::Serial;
    const bool was_slave = state_.slave;
    state_.slave = on() && !master();
    if (!master()) {
        state_.shifting = false;
        around_.events.cancel(slot_);
        ports_.release_value(kSck, kUser);
        ports_.release_value(kMosi, kUser);
    }
    for (const Pin pin : {kSs, kMosi, kSck}) {
        if (state_.slave)
            ports_.override_direction(pin, false);
        else
            ports_.release_direction(pin);
    }
    check_lost();
    if (master()) {
        ports_.release_value(kMiso, kUser);
        ports_.override_direction(kMiso, false);
        ports_.override_value(kSck, clock_idle(), kUser);
        show_bit();
        if (!state_.shifting) state_.edges = 0;
    } else if (state_.slave) {
        if (!was_slave) select(!ports_.level(kSs));
    } else {
        ports_.release_value(kMiso, kUser);
        ports_.release_direction(kMiso);
    }
}

// A master whose SS is an input that is pulled low becomes a slave.
void Spi::check_lost() {
    if (!master() || ports_.output(kSs) || ports_.level(kSs)) return;
    control() &= static_cast<std::uint8_t>(~kMstr);
    status() |= kSpif;
    configure();
    update_request();
}

// SS high resets a slave's logic, drops what came in of a byte and takes MISO off the line.
void Spi::select(bool on) {
    state_.edges = 0;
    state_.selected = on;
    if (!on) {
        ports_.release_value(kMiso, PinUser::Serial);
        ports_.override_direction(kMiso, false);
        return;
    }
    ports_.release_direction(kMiso);
    if (!(control() & kCpha)) show_bit();
}

void Spi::show_bit() {
    const bool level = state_.shift & (control() & kDord ? kLowest : kHighest);
    ports_.override_value(master() ? kMosi : kMiso, level, PinUser::Serial);
}

// One edge of SCK, the first of a byte being the leading one. CPHA = 0: bits are sampled at leading edges and
// change at trailing ones; CPHA = 1: the other way round. `whole`: the byte that a board put in place of the
// bits at the pin.
void Spi::edge(std::optional<std::uint8_t> whole) {
    const bool leading = state_.edges % 2 == 0;
    const bool late = control() & kCpha;
    const bool lowest_first = control() & kDord;
    ++state_.edges;
    if (leading && late) return show_bit();
    if (leading || late) state_.incoming = ports_.level(master() ? kMiso : kMosi);
    if (leading) return;
    const std::uint8_t in = state_.incoming ? (lowest_first ? kHighest : kLowest) : std::uint8_t{0};
    state_.shift = static_cast<std::uint8_t>((lowest_first ? state_.shift >> 1 : state_.shift << 1) | in);
    if (state_.edges == kEdges) {
        if (whole) state_.shift = *whole;
        complete(state_.shift);
    }
    if (!late && (state_.slave || state_.edges != 0)) show_bit();
}

void Spi::due(void* owner, Cycle cycle) {
    auto& self = *static_cast<Spi*>(owner);
    State& st = self.state_;
    std::optional<std::uint8_t> whole;
    if (st.edges + 1 == kEdges)
        whole = self.pins_.spi_exchange(st.sent, cycle);
    else
        self.around_.events.schedule(self.slot_, cycle + st.half);
    const bool leading = st.edges % 2 == 0;
    const bool level = leading != self.clock_idle();
    // What is sampled at this edge is what stands at the pin before it.
    const bool samples = leading != static_cast<bool>(self.control() & kCpha);
    if (samples) self.edge(whole);
    self.ports_.override_value(kSck, level, PinUser::Serial);
    if (!samples) self.edge(whole);
}

void Spi::pins_changed(void* owner, PortLetter port, std::uint8_t before, std::uint8_t after, Cycle) {
    auto& self = *static_cast<Spi*>(owner);
    if (port != PortLetter::B || !self.on()) return;
    const auto changed = static_cast<std::uint8_t>(before ^ after);
    if (self.master()) {
        if (changed & kSs.mask()) self.check_lost();
        return;
    }
    if (changed & kSs.mask()) self.select(!(after & kSs.mask()));
    if (!self.state_.selected || !(changed & kSck.mask())) return;
    const bool leading = static_cast<bool>(after & kSck.mask()) != self.clock_idle();
    if (leading == (self.state_.edges % 2 == 0)) self.edge(std::nullopt);
}

void Spi::drivers_changed(void* owner, PortLetter port) {
    if (port == PortLetter::B) static_cast<Spi*>(owner)->check_lost();
}

// ---- registers

std::uint8_t Spi::read_status(void* owner, std::uint16_t) {
    auto& self = *static_cast<Spi*>(owner);
    self.state_.status_read = self.status() & (kSpif | kWcol);
    return self.status();
}
void Spi::write_status(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Spi*>(owner);
    self.status() = merged(self.status(), value, mask & kSpi2x);
}
void Spi::write_control(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Spi*>(owner);
    if (!self.powered()) return;
    const std::uint8_t old = self.control();
    self.around_.io.store(address, value, mask);
    constexpr auto kRates = static_cast<std::uint8_t>(~(kSpie | bit(1) | bit(0)));
    if ((old ^ self.control()) & kRates) self.configure();
    self.update_request();
}

std::uint8_t Spi::read_data(void* owner, std::uint16_t) {
    auto& self = *static_cast<Spi*>(owner);
    if (self.state_.status_read) {
        self.state_.status_read = false;
        self.status() &= static_cast<std::uint8_t>(~(kSpif | kWcol));
        self.update_request();
    }
    return self.state_.received;
}

void Spi::write_data(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t) {
    auto& self = *static_cast<Spi*>(owner);
    State& st = self.state_;
    if (!self.powered()) return;
    read_data(owner, kSpdr);
    if (st.shifting || (st.selected && st.edges != 0)) {
        self.status() |= kWcol;
        return;
    }
    self.check_lost();
    if (self.master() && st.completed_at != 0 && self.around_.now == st.completed_at) value = 0;
    st.shift = st.sent = value;
    if (st.slave) {
        if (st.selected && !(self.control() & kCpha)) self.show_bit();
        return;
    }
    if (!self.master()) return;
    st.shifting = true;
    st.edges = 0;
    Cycle divider = kDividers[field(self.control(), 1, 0)];
    if (self.status() & kSpi2x) divider /= 2;
    st.half = divider / 2;
    if (!(self.control() & kCpha)) self.show_bit();
    self.around_.events.schedule(self.slot_, self.around_.now + 1 + st.half);
}

}  // namespace puckloop::avr
