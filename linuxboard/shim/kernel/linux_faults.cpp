#include "linuxboard/shim/kernel/linux_faults.h"

#include "base/error.h"
#include "linuxboard/shim/devices/tty_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace puckloop::linuxboard {

using cosim::CarriedFault;
using cosim::kNever;
using cosim::Time;

namespace {

constexpr int kErrors = 134;  // Linux' errno values

int error_named(const std::string& name) {
    for (int number = 1; number < kErrors; ++number) {
        const char* known = strerrorname_np(number);
        if (known != nullptr && name == known) return number;
    }
    return 0;
}

bool is_instant(std::string_view kind) {
    return kind == "hang_up" || kind == "pause" || kind == "kill" || kind == "restart";
}

/// `now` with the part named `setting` as it is in `before`.
void keep(const std::string& setting, const termios& before, termios& now) {
    const auto keep_flags = [&](tcflag_t mask) {
        now.c_cflag = (now.c_cflag & ~mask) | (before.c_cflag & mask);
    };
    if (setting == "baud") {
        cfsetospeed(&now, cfgetospeed(&before));
        cfsetispeed(&now, cfgetispeed(&before));
    } else if (setting == "data_bits") {
        keep_flags(CSIZE);
    } else if (setting == "parity") {
        keep_flags(PARENB | PARODD);
    } else if (setting == "stop_bits") {
        keep_flags(CSTOPB);
    } else if (setting == "mode") {
        now.c_lflag = before.c_lflag;
        now.c_iflag = before.c_iflag;
        now.c_oflag = before.c_oflag;
    } else {
        now.c_cc[VMIN] = before.c_cc[VMIN];
        now.c_cc[VTIME] = before.c_cc[VTIME];
    }
}

bool same(const termios& a, const termios& b) {
    return a.c_cflag == b.c_cflag && a.c_lflag == b.c_lflag && a.c_iflag == b.c_iflag &&
           a.c_oflag == b.c_oflag && std::memcmp(a.c_cc, b.c_cc, sizeof a.c_cc) == 0;
}

}  // namespace

std::optional<LinuxFaults::Kind> LinuxFaults::kind_of(std::string_view name) {
    constexpr std::array<std::string_view, static_cast<std::size_t>(kLast) + 1> kNames{
        "read_error",   "write_error", "short_read", "short_write", "termios_refused",
        "termios_baud", "i2c_error",   "hang_up",    "pause",       "starve",
        "kill",         "restart",     "dns_silence"};
    const auto* found = std::find(kNames.begin(), kNames.end(), name);
    if (found == kNames.end()) return std::nullopt;
    return static_cast<Kind>(found - kNames.begin());
}

LinuxFaults::LinuxFaults(std::vector<CarriedFault> faults) : faults_(std::move(faults)) {
    for (const CarriedFault& fault : faults_) {
        const auto kind = kind_of(fault.spec.kind);
        if (!kind)
            throw InputError("", fmt::format("fault on node {}", fault.spec.node),
                             fmt::format("a Linux program knows no fault '{}'", fault.spec.kind));
        kinds_.push_back(*kind);
        watches_calls_ = watches_calls_ || *kind <= Kind::ShortWrite;
        Time next = kNever;
        if (is_instant(fault.spec.kind)) next = fault.trigger.instant(0);
        if (*kind == Kind::Starve) next = fault.spec.begin;
        next_.push_back(next);
    }
}

bool LinuxFaults::restarts_after(Time now) const {
    for (std::size_t i = 0; i < faults_.size(); ++i)
        if (kinds_[i] == Kind::Restart && next_[i] < kNever && next_[i] >= now && !faults_[i].trigger.spent())
            return true;
    return false;
}

CallDamage LinuxFaults::strike(Time now, std::size_t bytes, Kind error, Kind shortens, const char* call) {
    CallDamage damage;
    ++calls_;
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        CarriedFault& fault = faults_[i];
        if (kinds_[i] == error && fault.trigger.fires(now)) {
            const std::string name = fault.spec.parameters.text("errno", "EIO");
            damage.error = error_named(name);
            fault.fired(now, calls_, fmt::format("{} of {} bytes fails with {}", call, bytes, name));
        } else if (kinds_[i] == shortens) {
            const auto most = static_cast<std::size_t>(fault.spec.parameters.number("most", 1.0));
            if (bytes <= most || !fault.trigger.fires(now)) continue;
            damage.most = std::min(damage.most, most);
            fault.fired(now, calls_, fmt::format("{} of {} bytes moves {} at most", call, bytes, most));
        }
    }
    return damage;
}

CallDamage LinuxFaults::read(Time now, std::size_t bytes) {
    return strike(now, bytes, Kind::ReadError, Kind::ShortRead, "read");
}

CallDamage LinuxFaults::write(Time now, std::size_t bytes) {
    return strike(now, bytes, Kind::WriteError, Kind::ShortWrite, "write");
}

int LinuxFaults::transfer(Time now, const std::vector<std::uint16_t>& addresses) {
    int error = 0;
    ++calls_;
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        CarriedFault& fault = faults_[i];
        if (kinds_[i] != Kind::I2cError) continue;
        const auto& parameters = fault.spec.parameters;
        if (parameters.has("address") &&
            std::find(addresses.begin(), addresses.end(),
                      static_cast<std::uint16_t>(parameters.number("address"))) == addresses.end())
            continue;
        if (!fault.trigger.fires(now)) continue;
        const std::string name = parameters.text("errno", "EIO");
        error = error_named(name);
        fault.fired(now, calls_,
                    fmt::format("transfer of {} messages to 0x{:02x} fails with {}", addresses.size(),
                                addresses.empty() ? 0 : addresses.front(), name));
    }
    return error;
}

termios LinuxFaults::configure(Time now, const termios& before, const termios& wanted) {
    termios effective = wanted;
    rate_factor_ = 1.0;
    ++calls_;
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        CarriedFault& fault = faults_[i];
        if (kinds_[i] == Kind::TermiosRefused) {
            const std::string setting = fault.spec.parameters.text("setting", "baud");
            termios kept = effective;
            keep(setting, before, kept);
            if (same(kept, effective) || !fault.trigger.fires(now)) continue;
            effective = kept;
            fault.fired(now, calls_, fmt::format("tcsetattr leaves {} as it was", setting));
        } else if (kinds_[i] == Kind::TermiosBaud) {
            const double asked = baud_rate(cfgetospeed(&effective));
            const double baud = fault.spec.parameters.number("baud");
            if (asked <= 0 || !fault.trigger.fires(now)) continue;
            rate_factor_ = baud / asked;
            fault.fired(now, calls_, fmt::format("{:g} baud asked for; {:g} take effect", asked, baud));
        }
    }
    return effective;
}

bool LinuxFaults::concern_names(const std::vector<CarriedFault>& faults) {
    return std::any_of(faults.begin(), faults.end(), [](const CarriedFault& fault) {
        return kind_of(fault.spec.kind) == Kind::DnsSilence;
    });
}

/// A resolver asks, and asks again when an answer does not come in time: the first question outside of all
/// windows is answered.
LinuxFaults::Resolution LinuxFaults::resolve(Time now, std::string_view name) {
    Resolution result{now, false};
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        CarriedFault& fault = faults_[i];
        if (kinds_[i] != Kind::DnsSilence || result.failed || !fault.trigger.open(result.until)) continue;
        const auto& parameters = fault.spec.parameters;
        const Time begin = result.until, timeout = parameters.time("timeout");
        int left = static_cast<int>(parameters.number("attempts"));
        while (left > 0 && fault.trigger.open(result.until)) {
            result.until = cosim::later(result.until, timeout);
            --left;
        }
        result.failed = left == 0;
        fault.fired(now, ++calls_,
                    fmt::format("{} is not answered for {:.3f} s{}", name,
                                cosim::to_seconds(result.until - begin),
                                result.failed ? "" : " and then is"));
    }
    return result;
}

bool LinuxFaults::silences(Time now, std::string_view name) {
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        if (kinds_[i] != Kind::DnsSilence || !faults_[i].trigger.open(now)) continue;
        faults_[i].fired(now, ++calls_, fmt::format("the question for {} is not answered", name));
        return true;
    }
    return false;
}

Time LinuxFaults::next() const {
    return next_.empty() ? kNever : *std::min_element(next_.begin(), next_.end());
}

ProcessDamage LinuxFaults::happen(Time now, bool runs) {
    ProcessDamage damage;
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        if (next_[i] > now) continue;
        CarriedFault& fault = faults_[i];
        if (kinds_[i] == Kind::Starve) {
            const bool begins = now < fault.spec.end;
            next_[i] = begins && fault.spec.end < kNever ? fault.spec.end : kNever;
            damage.charge_factor = begins ? fault.spec.parameters.number("factor", 1.0) : 1.0;
            if (begins)
                fault.fired(now, 0, fmt::format("each call costs {:g} times as much", *damage.charge_factor));
            continue;
        }
        next_[i] = fault.trigger.instant(now + 1);
        if (runs && fault.trigger.fires(now)) at_instant(i, now, damage);
    }
    return damage;
}

void LinuxFaults::at_instant(std::size_t index, Time now, ProcessDamage& damage) {
    CarriedFault& fault = faults_[index];
    const auto& parameters = fault.spec.parameters;
    switch (kinds_[index]) {
    case Kind::HangUp:
        damage.hung_up = true;
        fault.fired(now, 0, "the serial port is hung up");
        break;
    case Kind::Pause: {
        const Time length = parameters.time("time");
        damage.paused_until = std::max(damage.paused_until, cosim::later(now, length));
        fault.fired(now, 0, fmt::format("stopped for {:.6f} s", cosim::to_seconds(length)));
        break;
    }
    case Kind::Kill:
        damage.killed = true;
        damage.ends_run = damage.ends_run || parameters.text("run", "ends") == "ends";
        fault.fired(now, 0, "killed");
        break;
    case Kind::Restart:
        damage.killed = true;
        damage.restarted_at = cosim::later(now, parameters.time("down"));
        fault.fired(now, 0,
                    fmt::format("killed and started again {:.6f} s later",
                                cosim::to_seconds(parameters.time("down"))));
        break;
    default:
        break;
    }
}

}  // namespace puckloop::linuxboard
