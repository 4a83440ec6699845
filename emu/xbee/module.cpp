#include "emu/xbee/module.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace puckloop::xbee {

using cosim::Time;
using protocols::XBeeBytes;

namespace {

constexpr std::uint32_t kTransparent = 0, kEscapedMode = 2;  // AP
constexpr std::uint8_t kWatchdogReset = 1;

}  // namespace

Module::Module(const ModuleOptions& options, ModuleAir& air)
    : options_(options), air_(air), discovery_random_(options.seed, options.name + "/discovery") {
    const auto refuse = [&](const std::string& what, const char* expected) {
        throw InputError("", "radio module " + options.name, what, expected);
    };
    for (const auto& [command, value] : options.parameters) {
        const auto place = find_parameter(command);
        if (!place) refuse("no AT parameter " + command, "one of the module's");
        XBeeBytes octets;
        for (int shift = 8 * (at_table()[*place].octets - 1); shift >= 0; shift -= 8)
            octets.push_back(static_cast<std::uint8_t>(value >> shift));
        const bool whole = at_table()[*place].octets >= 4 || value >> 8 * at_table()[*place].octets == 0;
        if (!whole || settings_.write(*place, octets) != kAtOk)
            refuse(fmt::format("{} = {:#x} is out of range", command, value),
                   "a value that the module accepts");
    }
    const std::string& identifier = options.node_identifier;
    if (settings_.write_identifier(XBeeBytes(identifier.begin(), identifier.end())) != kAtOk)
        refuse("node identifier '" + identifier + "'", "1 to 20 printable characters");
    if (options.processing <= 0 || options.boot < options.processing)
        refuse("bad times", "0 < processing <= boot");
    settings_.apply();
    settings_.save();
    bit_ = bit_period_of(settings_[kBD]);
    out_.announce_bit_period(bit_);
    out_.set_bit_period(bit_);
    power(true, options.start);
}

// Power and reset ------------------------------------------------------------------------------------------

void Module::power(bool on, Time now) {
    if (on == powered_) return;
    powered_ = on;
    forget_everything();
    if (on && !in_reset_)
        add(now + options_.boot, {TaskKind::Boot, 0});
    else
        add(now + options_.processing, {TaskKind::RadioOff, 0});
}

void Module::reset_pin(bool asserted, Time now) {
    if (asserted == in_reset_) return;
    in_reset_ = asserted;
    if (!powered_) return;
    forget_everything();
    if (asserted) {
        ++counts_.resets;
        add(now + options_.processing, {TaskKind::RadioOff, 0});
    } else {
        add(now + options_.boot, {TaskKind::Boot, 0});
    }
}

void Module::rts(bool level, Time now) {
    rts_ = level;
    add(now + options_.processing, {TaskKind::Rts, level ? 1u : 0u});
}

void Module::forget_everything() {
    // Bytes that are being received are lost by being down; that the radio goes off must still be said.
    std::erase_if(tasks_, [](const auto& one) {
        return one.second.kind != TaskKind::RadioOff && one.second.kind != TaskKind::Rts &&
               one.second.kind != TaskKind::SleepPin;
    });
    up_ = false;
    out_.clear();
    waiting_.clear();
    waiting_bytes_ = partial_bytes_ = 0;
    input_scheduled_ = false;
    plain_.clear();
    plus_ = 0;
    command_mode_ = asleep_ = false;
    line_.clear();
    lines_.clear();
    heard_meanwhile_.clear();
    packets_.clear();
    discoveries_.clear();
    remotes_.clear();
}

void Module::boot(std::uint8_t status, Time now) {
    settings_.reset();
    new_reader(api_mode());
    bit_ = bit_period_of(settings_[kBD]);
    out_.set_bit_period(bit_);
    up_ = true;
    apply(now);
    update_cts(now);  // of the life before it may still be high
    if (settings_[kAP] != kTransparent) to_host(protocols::XBeeModemStatus{status}, now);
}

void Module::tell_radio(bool on, Time now) {
    // PL, "TX power level".
    constexpr std::array<double, 5> kPower{-7.0, -1.7, -0.77, 0.62, 1.42};
    radio::RadioSettings set;
    set.on = on;
    set.channel = static_cast<std::uint8_t>(settings_[kCH]);
    set.pan = static_cast<std::uint16_t>(settings_[kID]);
    set.address = options_.address;
    set.dbm = static_cast<std::int8_t>(std::lround(kPower.at(settings_[kPL])));
    set.cca = static_cast<std::uint8_t>(settings_[kCA]);
    set.mac_retries = static_cast<std::uint8_t>(settings_[kRR]);
    set.repeats = static_cast<std::uint8_t>(settings_[kMT]);
    set.network_hops = static_cast<std::uint8_t>(settings_[kNH]);
    set.delay_slots = static_cast<std::uint8_t>(settings_[kNN]);
    set.network_retries = static_cast<std::uint8_t>(settings_[kMR]);
    if (announced_ == set) return;
    announced_ = set;
    air_.radio_sent(radio::encode(set), 0, now);
}

protocols::XBeeApiMode Module::api_mode() const {
    return settings_[kAP] == kEscapedMode ? protocols::XBeeApiMode::Escaped : protocols::XBeeApiMode::Plain;
}

void Module::new_reader(protocols::XBeeApiMode mode) {
    reader_mode_ = mode;
    reader_ = protocols::XBeeReader(mode);
    partial_bytes_ = 0;
}

void Module::apply(Time now) {
    settings_.apply();
    if (const Time bit = bit_period_of(settings_[kBD]); bit != bit_) {
        // Once the answer is out; the delay lets the medium of the line know in time of shorter bytes.
        add(now + std::max(options_.processing, SerialOut::kBitsToStop * bit_),
            {TaskKind::Baud, settings_[kBD]});
        bit_ = bit;
        out_.announce_bit_period(bit);
    }
    if (const auto mode = api_mode(); mode != reader_mode_) new_reader(mode);
    out_.hold(rts_ && settings_[kD6] == 1, now);
    tell_radio(!asleep_, now);
    consider_sleep(now);
}

// Tasks ----------------------------------------------------------------------------------------------------

void Module::run_until(Time until) {
    while (next_task() <= until) {
        const auto node = tasks_.extract(tasks_.begin());
        run_task(node.mapped(), node.key());
    }
}

Time Module::next_radio() const {
    Time next = cosim::kNever;
    for (const auto& [at, task] : tasks_) {
        if (at >= next) break;
        next = std::min(next, task.kind == TaskKind::Byte ? at + options_.processing : at);
    }
    return next;
}

Time Module::next_byte() const {
    return std::min(next_radio(), out_.next());
}

void Module::run_task(const Task& task, Time now) {
    switch (task.kind) {
    case TaskKind::Byte:
        byte(static_cast<std::uint8_t>(task.value), now);
        break;
    case TaskKind::Input: {
        input_scheduled_ = false;
        const auto [message, bytes] = std::move(waiting_.front());
        waiting_.pop_front();
        waiting_bytes_ -= bytes;
        handle(message, now);
        schedule_input(now);
        update_cts(now);
        break;
    }
    case TaskKind::Boot:
        boot(static_cast<std::uint8_t>(task.value), now);
        break;
    case TaskKind::Answer: {
        const auto& frame = task.frame;
        send(frame.kind, frame.target, frame.options, 0, frame.data, now);
        break;
    }
    case TaskKind::DiscoveryEnd:
        for (auto it = discoveries_.begin(); it != discoveries_.end(); ++it)
            if (it->sequence == task.value) {
                // ND has said all it found; DN found nobody.
                if (it->text)
                    discovery_over_in_command_mode(*it, now);
                else if (it->single && it->id != 0)
                    to_host(protocols::XBeeAtResponse{it->id, {'D', 'N'}, kAtError, {}}, now);
                discoveries_.erase(it);
                break;
            }
        break;
    case TaskKind::PacketEnd:
        fate({static_cast<std::uint16_t>(task.value), 0, radio::kNoNetworkAck, 0}, now);
        break;
    case TaskKind::RemoteEnd:
        if (const auto remote = remotes_.find(static_cast<std::uint16_t>(task.value));
            remote != remotes_.end()) {
            to_host(protocols::XBeeRemoteAtResponse{remote->second.id,
                                                    remote->second.to,
                                                    protocols::kXBeeUnknownNet,
                                                    remote->second.command,
                                                    kAtNoAnswer,
                                                    {}},
                    now);
            remotes_.erase(remote);
        }
        break;
    case TaskKind::Packetize:
        packetize(now);
        break;
    case TaskKind::Quiet:
        if (task.value == last_byte_) add(now + options_.processing, {TaskKind::Packetize});
        break;
    case TaskKind::Restart:
        forget_everything();
        ++counts_.resets;
        tell_radio(false, now);
        add(now + options_.boot, {TaskKind::Boot, kWatchdogReset});
        break;
    case TaskKind::Rts:
        out_.hold(task.value != 0 && settings_[kD6] == 1, now);
        break;
    case TaskKind::Heard:
        heard(task.frame, now);
        break;
    case TaskKind::Baud:
        out_.set_bit_period(bit_period_of(static_cast<std::uint32_t>(task.value)));
        break;
    case TaskKind::Fate:
        fate(task.fate, now);
        break;
    case TaskKind::Guard:
        if (task.value == last_byte_) guard_over(now);
        break;
    case TaskKind::CommandLine: {
        const std::string line = std::move(lines_.front());
        lines_.pop_front();
        command_line(line, now);
        break;
    }
    case TaskKind::CommandTimeout:
        if (task.value == command_turn_) leave_command_mode(now);
        break;
    case TaskKind::SleepPin:
        consider_sleep(now);
        break;
    case TaskKind::Sleep:
        if (task.value == sleep_turn_ && !asleep_ && wants_sleep()) fall_asleep(now);
        break;
    case TaskKind::Wake:
        if (task.value == sleep_turn_ && asleep_) wake_up(now);
        break;
    case TaskKind::RadioOff:
        if (!up_) tell_radio(false, now);
        break;
    }
}

}  // namespace puckloop::xbee
