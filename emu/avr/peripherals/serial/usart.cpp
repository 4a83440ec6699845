#include "emu/avr/peripherals/serial/usart.h"

#include "emu/avr/peripherals/shared_registers.h"

#include "protocols/serial/uart_sampling.h"

#include <bit>
#include <utility>

namespace puckloop::avr {

namespace {

// UCSRnA
constexpr std::uint8_t kRxc = bit(7), kTxc = bit(6), kUdre = bit(5), kFe = bit(4), kDor = bit(3),
                       kUpe = bit(2), kU2x = bit(1), kMpcm = bit(0);
constexpr std::uint8_t kErrors = kFe | kDor | kUpe;
// UCSRnB
constexpr std::uint8_t kRxcie = bit(7), kTxcie = bit(6), kUdrie = bit(5), kRxen = bit(4), kTxen = bit(3),
                       kUcsz2 = bit(2), kRxb8 = bit(1), kTxb8 = bit(0);
// UCSRnC
constexpr std::uint8_t kUsbs = bit(3), kUdord = bit(2), kUcpha = bit(1), kUcpol = bit(0);
enum UsartMode : unsigned { kAsynchronous, kSynchronous, kReserved, kSpiMaster };  // UMSELn

constexpr std::uint16_t kNinthBit = bit(7) << 1;
constexpr std::size_t kFifo = 2;

}  // namespace

Usart::Usart(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock, Ports& ports,
             Pins& pins)
    : around_(around),
      setup_(setup),
      clock_(clock),
      ports_(ports),
      pins_(pins),
      receiver_(clock),
      clocked_(around, clock, ports, *this, setup.xck, setup.rxd, setup.txd),
      transmit_slot_(around.events.add(this, &transmit_due)),
      receive_slot_(around.events.add(this, &receive_due)) {
    const auto at = [&](int offset) { return static_cast<std::uint16_t>(setup_.base + offset); };
    around_.io.hook(at(0), this, nullptr, &write_a);
    around_.io.hook(at(1), this, nullptr, &write_b);
    around_.io.hook(at(2), this, nullptr, &write_c);
    around_.io.hook(at(4), this, nullptr, &write_baud);
    around_.io.hook(at(5), this, nullptr, &write_baud);
    around_.io.hook(at(6), this, &read_data, &write_data);
    around_.interrupts.connect(setup_.receive_vector, this, nullptr);
    around_.interrupts.connect(setup_.receive_vector + 1, this, nullptr);
    around_.interrupts.connect(setup_.receive_vector + 2, this, &acknowledge_transmitted);
}

void Usart::reset() {
    state_ = {};
    state_.phase = around_.now;
    around_.events.cancel(transmit_slot_);
    around_.events.cancel(receive_slot_);
    clocked_.reset();
}

unsigned Usart::mode() const {
    return field(c(), 7, 6);
}
bool Usart::clocked() const {
    return mode() == kSynchronous || mode() == kSpiMaster;
}

void Usart::configure_clocked() {
    using Clocked = ClockedUsart;
    Clocked::Format format;
    if (mode() == kSynchronous)
        format = {Clocked::Mode::Synchronous,
                  static_cast<std::uint8_t>(data_bits()),
                  static_cast<std::uint8_t>(parity()),
                  static_cast<std::uint8_t>(c() & kUsbs ? 2 : 1),
                  static_cast<bool>(c() & kUcpol),
                  false,
                  false,
                  divisor()};
    else if (mode() == kSpiMaster)
        format = {Clocked::Mode::SpiMaster,
                  8,
                  0,
                  1,
                  static_cast<bool>(c() & kUcpol),
                  static_cast<bool>(c() & kUcpha),
                  static_cast<bool>(c() & kUdord),
                  divisor()};
    clocked_.configure(format);
}

std::optional<std::uint16_t> Usart::take_word() {
    const std::optional<std::uint16_t> word = state_.buffer;
    state_.buffer.reset();
    if (word) a() |= kUdre;
    update_requests();
    return word;
}

void Usart::frame_out(const cosim::UartFrame& frame) {
    ++counters_.sent;
    pins_.uart_sent(setup_.unit, frame);
}

void Usart::all_out() {
    a() |= kTxc;
    update_requests();
    if (!(b() & kTxen)) enable_transmitter(false);
}

void Usart::word_in(Cycle now, std::uint16_t word, bool framing_error, bool parity_error) {
    deliver({now, word, framing_error, parity_error});
}

std::uint32_t Usart::ticks_per_bit() const {
    return a() & kU2x ? 8 : 16;
}
int Usart::data_bits() const {
    const unsigned size = field(c(), 2, 1) | (b() & kUcsz2 ? 4u : 0u);
    return size == 7 ? 9 : size > 3 ? 8 : 5 + static_cast<int>(size);
}
/// As frames count it: 0 none, 1 odd, 2 even.
int Usart::parity() const {
    const unsigned mode = field(c(), 5, 4);
    return mode == 2 ? 2 : mode == 3 ? 1 : 0;
}
bool Usart::powered() const {
    return !(around_.io.raw(kPrr0) & setup_.power_bit);
}
bool Usart::receiving() const {
    return (b() & kRxen) && powered();
}
std::optional<cosim::UartFrame> Usart::begun() const {
    if (clocked()) return clocked_.begun();
    if (!state_.shifting || state_.stop_begun) return std::nullopt;
    return state_.frame;
}

// RXC and UDRE request as long as they are set, TXC until its routine is entered.
void Usart::update_requests() {
    around_.interrupts.request(setup_.receive_vector, (a() & kRxc) && (b() & kRxcie));
    around_.interrupts.request(setup_.receive_vector + 1, (a() & kUdre) && (b() & kUdrie));
    around_.interrupts.request(setup_.receive_vector + 2, (a() & kTxc) && (b() & kTxcie));
}

void Usart::acknowledge_transmitted(void* owner, int) {
    auto& self = *static_cast<Usart*>(owner);
    assign(self.a(), kTxc, false);
    self.update_requests();
}

// ---- transmitter

// Moves the buffered word into the empty shift register; its start bit begins at a tick at or after `from`.
void Usart::begin_frame(Cycle from) {
    if (!state_.buffer) return;
    const Cycle late = (from - state_.phase) % divisor();
    const Cycle start = from + (late ? divisor() - late : 0);
    cosim::UartFrame& frame = state_.frame;
    frame = {};
    frame.data_bits = static_cast<std::uint8_t>(data_bits());
    frame.parity = static_cast<std::uint8_t>(parity());
    frame.stop_bits = c() & kUsbs ? 2 : 1;
    frame.data = static_cast<std::uint16_t>(*state_.buffer & ((1u << frame.data_bits) - 1u));
    const bool odd_ones = std::popcount(frame.data) % 2;
    frame.parity_bit = frame.parity == 2 ? odd_ones : frame.parity == 1 ? !odd_ones : 0;
    state_.buffer.reset();
    const Cycle bit_cycles = static_cast<Cycle>(ticks_per_bit()) * divisor();
    const int bits = protocols::bits_before_stop(frame);
    const Cycle stop = start + bit_cycles * static_cast<Cycle>(bits);
    frame.start = clock_.time_of(start);
    // Rounded up, so that the stamp of the stop bit never lies before the event that hands the frame out.
    frame.bit_period = (clock_.time_of(stop) - frame.start + bits - 1) / bits;
    state_.frame_end = stop + bit_cycles * frame.stop_bits;
    state_.shifting = true;
    state_.stop_begun = false;
    a() |= kUdre;
    update_requests();
    around_.events.schedule(transmit_slot_, stop);
}

void Usart::transmit_due(void* owner, Cycle due) {
    auto& self = *static_cast<Usart*>(owner);
    State& st = self.state_;
    if (!st.stop_begun) {  // the stop bit begins: everybody can know the frame now
        st.stop_begun = true;
        self.around_.events.schedule(self.transmit_slot_, st.frame_end);
        ++self.counters_.sent;
        self.pins_.uart_sent(self.setup_.unit, st.frame);
        return;
    }
    st.shifting = false;
    if (st.buffer) return self.begin_frame(due);
    self.a() |= kTxc;
    self.update_requests();
    if (!(self.b() & kTxen)) self.enable_transmitter(false);
}

void Usart::enable_transmitter(bool on) {
    if (on) {
        ports_.override_value(setup_.txd, true, PinUser::Serial);
        ports_.override_direction(setup_.txd, true);
        // The data sheet has it that what is written to a disabled transmitter is ignored; silicon sends the
        // last of it once it is enabled (docs/measured_silicon.md).
        if (const auto word = std::exchange(state_.early, std::nullopt); word && (a() & kUdre))
            transmit(*word);
    } else if (!state_.shifting && !state_.buffer && !clocked_.busy()) {  // else once what was written is out
        ports_.release_value(setup_.txd, PinUser::Serial);
        ports_.release_direction(setup_.txd);
    }
}

void Usart::write_data(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t) {
    auto& self = *static_cast<Usart*>(owner);
    if (!(self.a() & kUdre) || !self.powered()) return;
    const auto word = static_cast<std::uint16_t>(value | (self.b() & kTxb8 ? kNinthBit : 0));
    if (self.b() & kTxen)
        self.transmit(word);
    else
        self.state_.early = word;  // in place of an earlier one
}

void Usart::transmit(std::uint16_t word) {
    state_.buffer = word;
    assign(a(), kUdre, false);
    update_requests();
    if (clocked())
        clocked_.kick();
    else if (!state_.shifting)
        begin_frame(around_.now + 1);
}

// ---- receiver

void Usart::receive(const cosim::UartFrame& frame, Cycle at) {
    receiver_.frame(frame);
    const bool heard = mode() == kSynchronous ? clocked_.sampling_phase().has_value() : !clocked();
    if (receiving() && heard)
        sample(at);
    else
        receiver_.pass(at);
}

// Takes characters off the line as far as they are complete at `now`, and plans the next one.
void Usart::sample(Cycle now) {
    chip::UartReceiver::Format format{divisor(), data_bits(), parity(), state_.phase, ticks_per_bit()};
    if (const auto phase = clocked_.sampling_phase()) {  // XCK samples once a bit
        format.divisor = 2 * divisor();
        format.phase = *phase;
        format.ticks = 1;
    }
    while (!state_.sampled || state_.sampled->done <= now) {
        if (state_.sampled) {
            const auto character = *state_.sampled;
            state_.sampled.reset();
            deliver(character);
        }
        state_.sampled = receiver_.next(format, now);
        if (!state_.sampled) break;
    }
    around_.events.schedule(receive_slot_, state_.sampled ? state_.sampled->done : receiver_.ask_again());
}

void Usart::receive_due(void* owner, Cycle due) {
    static_cast<Usart*>(owner)->sample(due);
}

// The FIFO holds two characters, the shift register a third; a fourth takes the third's place, and reports it
// (DOR).
void Usart::deliver(const chip::UartReceiver::Character& character) {
    ++counters_.received;
    counters_.framing_errors += character.framing_error;
    counters_.parity_errors += character.parity_error;
    // Multi-processor mode: frames without the address mark are dropped. The mark is the ninth bit, or with
    // fewer the first stop bit.
    const bool marked = data_bits() == 9 ? character.data & kNinthBit : !character.framing_error;
    if ((a() & kMpcm) && mode() != kSpiMaster && !marked) return;
    Received received{character.data, static_cast<std::uint8_t>((character.framing_error ? kFe : 0) |
                                                                (character.parity_error ? kUpe : 0))};
    if (state_.fifo.size() > kFifo) {
        ++counters_.overruns;
        state_.fifo.pop_back();
        received.errors |= kDor;
    }
    if (mode() == kSpiMaster) received.errors = 0;
    const bool waited = !state_.fifo.empty();
    state_.fifo.push_back(received);
    show_receiver();
    if (waited) around_.interrupts.again(setup_.receive_vector);
}

void Usart::show_receiver() {
    const bool any = !state_.fifo.empty();
    assign(a(), kRxc, any);
    a() = merged(a(), any ? state_.fifo.front().errors : std::uint8_t{0}, kErrors);
    assign(b(), kRxb8, any && (state_.fifo.front().data & kNinthBit));
    update_requests();
}

std::uint8_t Usart::read_data(void* owner, std::uint16_t address) {
    auto& self = *static_cast<Usart*>(owner);
    if (self.state_.fifo.empty()) return self.around_.io.raw(address);
    const auto data = static_cast<std::uint8_t>(self.state_.fifo.front().data);
    self.around_.io.raw(address) = data;
    self.state_.fifo.pop_front();
    self.show_receiver();
    return data;
}

void Usart::enable_receiver(bool on) {
    clocked_.restart_receiver();
    if (on) {
        receiver_.start(around_.now + 1);
        ports_.override_direction(setup_.rxd, false);
        return;
    }
    state_.fifo.clear();
    state_.sampled.reset();
    around_.events.cancel(receive_slot_);
    ports_.release_direction(setup_.rxd);
    show_receiver();
}

// ---- control

// TXC is cleared by writing a one; U2X and MPCM are stored; the rest only shows.
void Usart::write_a(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Usart*>(owner);
    self.a() = merged(self.a(), value, mask & (kU2x | kMpcm));
    if (value & mask & kTxc) assign(self.a(), kTxc, false);
    self.update_requests();
}

void Usart::write_b(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Usart*>(owner);
    const std::uint8_t old = self.b();
    self.b() = merged(old, value, mask & static_cast<std::uint8_t>(~kRxb8));
    const auto changed = static_cast<std::uint8_t>(old ^ self.b());
    if (changed & kRxen) self.enable_receiver(self.b() & kRxen);
    if (changed & kTxen) self.enable_transmitter(self.b() & kTxen);
    if (changed & kUcsz2) self.configure_clocked();
    self.update_requests();
}

void Usart::write_c(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Usart*>(owner);
    self.around_.io.store(address, value, mask);
    if (self.mode() == kReserved)
        self.around_.io.report_unmodelled(address, self.setup_.unit ? "UCSR1C.UMSEL1" : "UCSR0C.UMSEL0",
                                          true);
    self.configure_clocked();
}

// Writing the low byte restarts the generator.
void Usart::write_baud(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Usart*>(owner);
    self.around_.io.store(address, value, mask);
    if (address == self.setup_.base + 4) self.state_.phase = self.around_.now + 1;
    self.configure_clocked();
}

}  // namespace puckloop::avr
