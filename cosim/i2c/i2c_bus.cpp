#include "cosim/i2c/i2c_bus.h"

#include "cosim/i2c/i2c_figures.h"
#include "cosim/i2c/i2c_shared.h"

#include <algorithm>
#include <cmath>

namespace puckloop::cosim {

namespace {

std::uint8_t seven_bits(std::uint8_t address_byte) {
    return static_cast<std::uint8_t>(address_byte >> 1);
}

std::vector<std::string> names_of(const std::vector<I2cMasterPort>& masters) {
    std::vector<std::string> names;
    for (const I2cMasterPort& master : masters)
        names.push_back(master.name);
    return names;
}
}  // namespace

I2cBusNode::I2cBusNode(I2cBusOptions options, std::vector<std::unique_ptr<I2cSlave>> slaves)
    : options_(std::move(options)),
      slaves_(std::move(slaves)),
      nominal_period_(static_cast<Time>(std::llround(static_cast<double>(kSecond) / options_.nominal_hertz))),
      faults_(options_.faults, names_of(options_.masters), nominal_period_),
      log_(options_.log, names_of(options_.masters)) {
    log_.begin(device_list(), options_.nominal_hertz);
    for (const auto& master : options_.masters)
        ports_.push_back({master.name, PortKind::I2c});
    for (const auto& device : options_.devices)
        ports_.push_back({device.name, PortKind::I2c});
    const auto world = static_cast<PortIndex>(ports_.size());
    ports_.push_back({"world", PortKind::Signals});
    emit_ = [this, world](std::uint16_t id, double value) {
        answers_.push_back({emitted_at_, world, Signal{id, value}});
    };
    if (std::all_of(slaves_.begin(), slaves_.end(), [](const auto& slave) { return slave->rewindable(); }))
        going_back_.emplace(*this);
}

void I2cBusNode::GoingBack::mark() {
    bus_.log_.mark();
    for (const auto& slave : bus_.slaves_)
        slave->rewindable()->mark();
    checkpoint_.take(bus_);
}

void I2cBusNode::GoingBack::rewind() {
    bus_.log_.rewind();
    for (const auto& slave : bus_.slaves_)
        slave->rewindable()->rewind();
    checkpoint_.restore(bus_);
}

void I2cBusNode::GoingBack::settle() {
    for (const auto& slave : bus_.slaves_)
        slave->rewindable()->settle();
    bus_.log_.settle();
}

Time I2cBusNode::ninth_clock(const I2cPhase& phase) const {
    return phase.start + kClocksOfByte * std::max(phase.clock_period, nominal_period_);
}

void I2cBusNode::advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) {
    for (const Message& message : inbox) {
        run_events(message.time);
        now_ = message.time;
        receive(message);
    }
    run_events(until);
    now_ = until;
    // Answers leave as soon as they are known, stamped with the time at which they count: a master that
    // reacts at once would otherwise hold the bus at that very time.
    std::stable_sort(answers_.begin(), answers_.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
    outbox.insert(outbox.end(), answers_.begin(), answers_.end());
    answers_.clear();
}

/// Everything that the bus does by itself before `until`.
void I2cBusNode::run_events(Time until) {
    for (Time next = next_event(); next < until; next = next_event()) {
        now_ = next;
        if (line_released_ == next)
            line_released();
        else if (changes_ != next)
            begin_incomplete();
        else if (bus_ == Bus::Contest)
            resolve_contest();
        else
            bus_freed();
    }
}

Time I2cBusNode::next_event() const {
    const Time begins = bus_ == Bus::Free ? faults_.next_incomplete() : kNever;
    return std::min({changes_, line_released_, begins});
}

void I2cBusNode::receive(const Message& message) {
    if (const auto* signal = std::get_if<Signal>(&message.payload)) {
        for (const auto& slave : slaves_)
            slave->signal_at(signal->id, signal->value, message.time);
    } else if (const auto* phase = std::get_if<I2cPhase>(&message.payload)) {
        if (is_master(message.port))
            phase_from(message.port, *phase);
        else
            device_answered(message.port, *phase, message.time);
    }
}

void I2cBusNode::phase_from(PortIndex port, const I2cPhase& phase) {
    if (bus_ == Bus::Owned && shares(port)) return turn_from(port, phase);
    const bool owns = bus_ == Bus::Owned && owner_ == port;
    switch (phase.kind) {
    case I2cPhaseKind::Start:
        start_from(port, phase);
        break;
    case I2cPhaseKind::Stop:
        stop_from(port, phase);
        break;
    case I2cPhaseKind::Write:
    case I2cPhaseKind::Read:
        if (owns)
            byte_from(port, phase);
        else
            lose(port, phase);
        break;
    case I2cPhaseKind::Acknowledge:
        if (owns && phase.ack == 0) not_acknowledged(phase);
        if (owns && phase.ack != 0 && !pending_) ask_first_bit(port, phase);
        break;
    case I2cPhaseKind::BusLost:
        if (owns && !pending_) acknowledge_was_in_the_way(port, phase);
        break;
    case I2cPhaseKind::Data:
        if (owns && !pending_ && LooseClocks::of(phase.ack).valid()) begin_loose(port, phase);
        break;
    }
}

/// A device's acknowledge that nobody clocks holds SDA low.
void I2cBusNode::acknowledge_was_in_the_way(PortIndex port, const I2cPhase& phase) {
    ++counters_.lost;
    log_.lost(now_, port, phase);
    sda_held();
}

void I2cBusNode::start_from(PortIndex port, const I2cPhase& phase) {
    switch (bus_) {
    case Bus::Free:
        if (const Time free = faults_.free_from(port, phase.start); free > phase.start) {
            bus_ = Bus::Recovering;  // both masters' drivers look at the lines before they begin
            changes_ = free;
            break;
        }
        open_contest(port, phase);
        return;
    case Bus::Contest:
        open_contest(port, phase);
        return;
    case Bus::Owned:
        if (owner_ == port && !pending_) {
            release_devices(phase.start, Ending::RepeatedStart, phase.byte);
            address(port, phase, 0);
            return;
        }
        break;
    case Bus::Stopping:
    case Bus::Stuck:
    case Bus::HeldLow:
    case Bus::Recovering:
        break;
    }
    const bool waits = options_.masters[port].waits || bus_ == Bus::Stopping;
    if (!waits) return lose(port, phase);
    std::erase_if(waiting_, [&](const Contender& other) { return other.port == port; });
    waiting_.push_back({port, phase});
    if (bus_ == Bus::HeldLow) recover(phase.start);
}

void I2cBusNode::open_contest(PortIndex port, const I2cPhase& phase) {
    if (bus_ == Bus::Free) {
        bus_ = Bus::Contest;
        changes_ = phase.start + half_clock();
    }
    std::erase_if(contenders_, [&](const Contender& other) { return other.port == port; });
    contenders_.push_back({port, phase});
}

void I2cBusNode::resolve_contest() {
    const auto winner =
        std::min_element(contenders_.begin(), contenders_.end(), [](const Contender& a, const Contender& b) {
            return std::pair(a.phase.byte, a.port) < std::pair(b.phase.byte, b.port);
        });
    bus_ = Bus::Owned;
    owner_ = winner->port;
    const Time decided = changes_;
    changes_ = kNever;
    I2cPhase phase = winner->phase;
    for (const auto& contender : contenders_) {
        if (contender.phase.byte != phase.byte) {
            lose(contender.port, contender.phase);
            continue;
        }
        sharers_.push_back(contender.port);
    }
    if (sharers_.size() == 1) sharers_.clear();
    announce_ = !sharers_.empty();
    for (const auto& contender : contenders_) {
        if (!shares(contender.port)) continue;
        phase.start = std::max(phase.start, contender.phase.start);
        phase.clock_period = std::max(phase.clock_period, contender.phase.clock_period);
    }
    contenders_.clear();
    address(owner_, phase, decided);
}

void I2cBusNode::stop_from(PortIndex port, const I2cPhase& phase) {
    if (bus_ != Bus::Owned || owner_ != port) {  // it gave up before its turn came
        std::erase_if(waiting_, [&](const Contender& other) { return other.port == port; });
        return;
    }
    if (pending_ && !pending_->open.empty()) return hang();
    changes_ = phase.start + std::max(phase.clock_period, nominal_period_);
    if (const Time free = faults_.free_from(port, phase.start); free > phase.start) {
        bus_ = Bus::Recovering;  // the line's release makes the STOP
        changes_ = std::max(changes_, free);
        return;
    }
    release_devices(phase.start, Ending::Stop);
    bus_ = Bus::Stopping;
}

void I2cBusNode::bus_freed() {
    const Time now = changes_;
    if (bus_ == Bus::Recovering) release_devices(now, Ending::Stop);
    bus_ = Bus::Free;
    changes_ = kNever;
    if (begin_incomplete()) return;
    for (auto& contender : waiting_) {
        contender.phase.start = std::max(contender.phase.start, now);
        open_contest(contender.port, contender.phase);
    }
    waiting_.clear();
}

void I2cBusNode::lose(PortIndex port, const I2cPhase& phase, const I2cAnswer& reply, Time earliest) {
    ++counters_.lost;
    log_.lost(now_, port, phase);
    answer(port, phase, I2cPhaseKind::BusLost, reply, earliest);
}

void I2cBusNode::answer(PortIndex port, const I2cPhase& phase, I2cPhaseKind kind, const I2cAnswer& reply,
                        Time earliest) {
    if (kind == I2cPhaseKind::Acknowledge && !reply.acknowledge) {
        ++counters_.not_acknowledged;
        if (phase.kind == I2cPhaseKind::Start) ++counters_.absent[{port, seven_bits(phase.byte)}];
    }
    I2cPhase out = phase;
    out.kind = kind;
    out.byte = kind == I2cPhaseKind::Data ? reply.byte : phase.byte;
    out.ack = kind == I2cPhaseKind::Data ? phase.ack : (reply.acknowledge ? 1 : 0);
    held_ = kind == I2cPhaseKind::Data && !read_ && reply.acknowledge;
    if (held_) out.ack = kDeviceAcknowledges;
    out.stretch = reply.stretch;
    // What ends within the low half of a clock lengthens nothing on the wires.
    const bool stretched = reply.stretch > half_clock();
    counters_.stretched += stretched ? 1 : 0;
    counters_.longest_stretch = std::max(counters_.longest_stretch, reply.stretch);
    if (kind != I2cPhaseKind::BusLost)
        log_.answered(now_, port, out, phase.kind == I2cPhaseKind::Start, stretched);
    answers_.push_back({std::max(ninth_clock(phase), earliest) + reply.stretch, port, out});
}

Time I2cBusNode::earliest_output(PortIndex port) const {
    Time first = kNever;
    if (is_world(port))
        return later(bus_ == Bus::Recovering ? std::min(changes_, line_released_) : line_released_,
                     nominal_period_);
    if (!is_master(port)) return next_event();
    first = later(line_released_, nominal_period_);
    for (const Contender& contender : contenders_)
        if (contender.port == port) first = std::min(first, ninth_clock(contender.phase));
    // A Start that waits for another master's Stop is answered when that comes.
    if ((bus_ == Bus::Stopping || bus_ == Bus::Recovering) && !waiting_.empty())
        first = std::min(first, later(changes_, kClocksOfByte * nominal_period_));
    return first;
}

Time I2cBusNode::lookahead(PortIndex port) const {
    if (is_world(port)) return nominal_period_;
    if (!is_master(port)) return told_after(port);
    return awaits_devices() || !sharers_.empty() ? nominal_period_ : kClocksOfByte * nominal_period_;
}

}  // namespace puckloop::cosim
