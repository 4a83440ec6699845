#include "cosim/i2c_bus.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::cosim {

namespace {
constexpr Time kClocksOfByte = 9;
constexpr std::uint8_t kReadBit = 1;

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
}

std::string I2cBusNode::device_list() const {
    std::string list;
    for (const auto& slave : slaves_)
        list += fmt::format("{}{}", list.empty() ? "" : ", ", slave->name());
    for (const auto& device : options_.devices)
        list += fmt::format("{}{}", list.empty() ? "" : ", ", device.name);
    return list;
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
    while (changes_ < until) {
        now_ = changes_;
        if (bus_ == Bus::Contest)
            resolve_contest();
        else
            bus_freed();
    }
}

void I2cBusNode::receive(const Message& message) {
    if (const auto* signal = std::get_if<Signal>(&message.payload)) {
        for (const auto& slave : slaves_)
            slave->signal(signal->id, signal->value);
    } else if (const auto* phase = std::get_if<I2cPhase>(&message.payload)) {
        if (is_master(message.port))
            phase_from(message.port, *phase);
        else
            device_answered(message.port, *phase, message.time);
    }
}

void I2cBusNode::phase_from(PortIndex port, const I2cPhase& phase) {
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
    case I2cPhaseKind::Data:
    case I2cPhaseKind::BusLost:
        break;
    }
}

void I2cBusNode::byte_from(PortIndex port, const I2cPhase& phase) {
    const bool write = phase.kind == I2cPhaseKind::Write;
    ++(write ? counters_.bytes_written : counters_.bytes_read);
    if (pass_on(port, phase)) return;
    I2cAnswer reply;
    if (addressed_ != nullptr)
        reply = write ? addressed_->write(phase.byte, phase.start) : addressed_->read(phase.start);
    answer(port, phase, write ? I2cPhaseKind::Acknowledge : I2cPhaseKind::Data, reply, 0);
}

/// To the device in another node, if one is addressed.
bool I2cBusNode::pass_on(PortIndex port, const I2cPhase& phase) {
    if (!addressed_device_) return false;
    answers_.push_back({phase.start, *addressed_device_, phase});
    pending_ = Pending{port, phase};
    return true;
}

void I2cBusNode::device_answered(PortIndex port, const I2cPhase& phase, Time now) {
    if (!pending_ || addressed_device_ != port) return;
    const Pending pending = *pending_;
    pending_.reset();
    const bool read = pending.phase.kind == I2cPhaseKind::Read;
    const Time told = now + nominal_period_;
    I2cAnswer reply{phase.ack != 0, phase.byte, 0};
    reply.stretch = std::max<Time>(0, told - ninth_clock(pending.phase));
    if (pending.phase.kind == I2cPhaseKind::Start && !reply.acknowledge) addressed_device_.reset();
    answer(pending.master, pending.phase, read ? I2cPhaseKind::Data : I2cPhaseKind::Acknowledge, reply, 0);
}

void I2cBusNode::start_from(PortIndex port, const I2cPhase& phase) {
    switch (bus_) {
    case Bus::Free:
    case Bus::Contest:
        open_contest(port, phase);
        return;
    case Bus::Owned:
        if (owner_ == port) {
            release_slave(phase.start);
            address(port, phase, 0);
            return;
        }
        break;
    case Bus::Stopping:
        break;
    }
    const bool waits = options_.masters[port].waits || bus_ == Bus::Stopping;
    if (!waits) return lose(port, phase);
    std::erase_if(waiting_, [&](const Contender& other) { return other.port == port; });
    waiting_.push_back({port, phase});
}

void I2cBusNode::open_contest(PortIndex port, const I2cPhase& phase) {
    if (bus_ == Bus::Free) {
        bus_ = Bus::Contest;
        changes_ = phase.start + nominal_period_ / 2;
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
    for (const auto& contender : contenders_)
        if (contender.port != owner_) lose(contender.port, contender.phase);
    const I2cPhase phase = winner->phase;
    contenders_.clear();
    address(owner_, phase, decided);
}

void I2cBusNode::address(PortIndex port, const I2cPhase& phase, Time earliest) {
    ++counters_.transfers;
    log_.addressed(now_, port, phase.byte);
    if (address_device(port, phase, earliest)) return;
    const auto seven_bits = static_cast<std::uint8_t>(phase.byte >> 1);
    I2cAnswer reply;
    for (const auto& slave : slaves_)
        if (addressed_ == nullptr && slave->listens_to(seven_bits)) {
            reply = slave->start((phase.byte & kReadBit) != 0, phase.start);
            if (reply.acknowledge) addressed_ = slave.get();
        }
    answer(port, phase, I2cPhaseKind::Acknowledge, reply, earliest);
}

bool I2cBusNode::address_device(PortIndex port, const I2cPhase& phase, Time earliest) {
    for (std::size_t i = 0; i < options_.devices.size(); ++i) {
        const auto& addresses = options_.devices[i].addresses;
        if (std::find(addresses.begin(), addresses.end(), phase.byte >> 1) == addresses.end()) continue;
        addressed_device_ = static_cast<PortIndex>(options_.masters.size() + i);
        answers_.push_back({std::max(phase.start, earliest), *addressed_device_, phase});
        pending_ = Pending{port, phase};
        return true;
    }
    return false;
}

void I2cBusNode::release_slave(Time now) {
    pending_.reset();
    if (addressed_device_) {
        I2cPhase stop;
        stop.start = now;
        answers_.push_back({now, *addressed_device_, stop});
        addressed_device_.reset();
    }
    if (addressed_ == nullptr) return;
    emitted_at_ = now + nominal_period_;
    addressed_->stop(now, emit_);
    addressed_ = nullptr;
}

void I2cBusNode::stop_from(PortIndex port, const I2cPhase& phase) {
    if (bus_ != Bus::Owned || owner_ != port) {  // it gave up before its turn came
        std::erase_if(waiting_, [&](const Contender& other) { return other.port == port; });
        return;
    }
    release_slave(phase.start);
    bus_ = Bus::Stopping;
    changes_ = phase.start + std::max(phase.clock_period, nominal_period_);
}

void I2cBusNode::bus_freed() {
    const Time now = changes_;
    bus_ = Bus::Free;
    changes_ = kNever;
    for (auto& contender : waiting_) {
        contender.phase.start = std::max(contender.phase.start, now);
        open_contest(contender.port, contender.phase);
    }
    waiting_.clear();
}

void I2cBusNode::lose(PortIndex port, const I2cPhase& phase) {
    ++counters_.lost;
    log_.lost(now_, port, phase);
    answer(port, phase, I2cPhaseKind::BusLost, {}, 0);
}

void I2cBusNode::answer(PortIndex port, const I2cPhase& phase, I2cPhaseKind kind, const I2cAnswer& reply,
                        Time earliest) {
    if (kind == I2cPhaseKind::Acknowledge && !reply.acknowledge) ++counters_.not_acknowledged;
    I2cPhase out = phase;
    out.kind = kind;
    out.byte = kind == I2cPhaseKind::Data ? reply.byte : phase.byte;
    out.ack = kind == I2cPhaseKind::Data ? phase.ack : (reply.acknowledge ? 1 : 0);
    out.stretch = reply.stretch;
    if (kind != I2cPhaseKind::BusLost) log_.answered(now_, port, out, phase.kind == I2cPhaseKind::Start);
    answers_.push_back({std::max(ninth_clock(phase), earliest) + reply.stretch, port, out});
}

Time I2cBusNode::promise(PortIndex port) const {
    Time first = kNever;
    if (is_world(port)) return first;
    if (!is_master(port)) return changes_;
    for (const Contender& contender : contenders_)
        if (contender.port == port) first = std::min(first, ninth_clock(contender.phase));
    // A Start that waits for another master's Stop is answered in reaction to it.
    if (bus_ == Bus::Stopping && !waiting_.empty())
        first = std::min(first, later(changes_, kClocksOfByte * nominal_period_));
    return first;
}

Time I2cBusNode::reaction(PortIndex port) const {
    if (is_world(port)) return nominal_period_;
    if (!is_master(port)) return 0;
    return options_.devices.empty() ? kClocksOfByte * nominal_period_ : nominal_period_;
}

std::string I2cBusNode::finish() {
    log_.end(now_,
             fmt::format("{} transfers, {} bytes written, {} read, {} not acknowledged, bus lost {} times",
                         counters_.transfers, counters_.bytes_written, counters_.bytes_read,
                         counters_.not_acknowledged, counters_.lost));
    std::string devices;
    for (const auto& slave : slaves_)
        devices += fmt::format("{}\"{}\":{}", devices.empty() ? "" : ",", slave->name(), slave->report());
    return fmt::format(
        R"({{"transfers":{},"not_acknowledged":{},"lost":{},"bytes_written":{},"bytes_read":{},)"
        R"("devices":{{{}}}}})",
        counters_.transfers, counters_.not_acknowledged, counters_.lost, counters_.bytes_written,
        counters_.bytes_read, devices);
}

}  // namespace puckloop::cosim
