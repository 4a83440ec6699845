#include "linuxboard/shim/kernel/spec.h"

#include "base/error.h"
#include "base/fields/json.h"
#include "linuxboard/shim/wire/board_clock.h"

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <stdexcept>

namespace puckloop::linuxboard {

namespace {

constexpr double kPicosecondsPerMicrosecond = 1e6;

/// Charges as descriptions have them.
struct Microseconds {
    double clock, device, sync, thread, yield;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        const auto charge = [](auto one) { return one.in("us").at_least(0.001); };
        return visit(charge(field("clock", &Microseconds::clock, "a look at the clock")),
                     charge(field("device", &Microseconds::device, "a call of a device")),
                     charge(field("sync", &Microseconds::sync, "a lock")),
                     charge(field("thread", &Microseconds::thread, "making a thread")),
                     charge(field("yield", &Microseconds::yield, "sched_yield")));
    }
};
static_assert(lists_all_fields<Microseconds>);

/// Delays of sleeps as descriptions have them.
struct SleepDelay {
    cosim::Time mean = 0;
    cosim::Time jitter = 0;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("mean_s", &SleepDelay::mean, "a sleep ends so much later than asked")
                         .in("s")
                         .as<cosim::Seconds>(),
                     field("jitter_s", &SleepDelay::jitter, "standard deviation; by it no sleep ends early")
                         .in("s")
                         .at_least(0)
                         .as<cosim::Seconds>());
    }
};
static_assert(lists_all_fields<SleepDelay>);

Microseconds microseconds(const wire::Charges& charges) {
    const auto us = [](std::int64_t charge) {
        return static_cast<double>(charge) / kPicosecondsPerMicrosecond;
    };
    return {us(charges.clock), us(charges.device), us(charges.sync), us(charges.thread), us(charges.yield)};
}

void refuse(const char* key, const char* problem) {
    throw InputError("", std::string("linux") + (*key ? "." : "") + key, problem);
}

}  // namespace

std::optional<int> signal_named(std::string_view name) {
    for (int number = 1; number < NSIG; ++number) {
        const char* abbreviation = sigabbrev_np(number);
        if (abbreviation != nullptr && (name == abbreviation || name == std::string("SIG") + abbreviation))
            return number;
    }
    return std::nullopt;
}

JsonValue SignalForm::write(int signal) {
    const char* abbreviation = sigabbrev_np(signal);
    return abbreviation != nullptr ? JsonValue(abbreviation) : JsonValue(signal);
}

void SignalForm::read(int& signal, const JsonValue& from, const std::string& place) {
    if (from.is_integer()) return from_value(signal, from, place);
    const auto number = from.text() != nullptr ? signal_named(*from.text()) : std::nullopt;
    if (!number) throw InputError("", place, "is not a signal", "a name such as \"INT\" or a number");
    signal = *number;
}

JsonValue I2cErrorForm::write(int number) {
    return strerrorname_np(number);
}

void I2cErrorForm::read(int& number, const JsonValue& from, const std::string& place) {
    std::string name;
    from_value(name, from, place);
    for (const int one : {EREMOTEIO, ENXIO, EIO, ETIMEDOUT}) {
        if (name != strerrorname_np(one)) continue;
        number = one;
        return;
    }
    throw InputError("", place, "is not an error an I2C driver gives", "EREMOTEIO, ENXIO, EIO or ETIMEDOUT");
}

JsonValue ChargesForm::write(const wire::Charges& charges) {
    return to_value(microseconds(charges));
}

void ChargesForm::read(wire::Charges& charges, const JsonValue& from, const std::string& place) {
    Microseconds us = microseconds(charges);
    from_value(us, from, place);
    const auto picoseconds = [](double charge) {
        return static_cast<std::int64_t>(std::llround(charge * kPicosecondsPerMicrosecond));
    };
    charges = {picoseconds(us.clock), picoseconds(us.device), picoseconds(us.sync), picoseconds(us.thread),
               picoseconds(us.yield)};
}

JsonValue OversleepForm::write(const wire::Oversleep& oversleep) {
    return to_value(SleepDelay{oversleep.mean, oversleep.jitter});
}

void OversleepForm::read(wire::Oversleep& oversleep, const JsonValue& from, const std::string& place) {
    SleepDelay delay{oversleep.mean, oversleep.jitter};
    from_value(delay, from, place);
    oversleep = {delay.mean, delay.jitter};
}

JsonValue EnvironmentForm::write(const List& variables) {
    JsonValue object = JsonValue::Object{};
    for (const auto& [name, value] : variables)
        object.set(name, value);
    return object;
}

void EnvironmentForm::read(List& variables, const JsonValue& from, const std::string& place) {
    std::map<std::string, std::string> values;
    from_value(values, from, place);
    variables.assign(values.begin(), values.end());
}

void check(const LinuxSpec& spec) {
    for (std::size_t i = 1; i < spec.restarts.size(); ++i)
        if (spec.restarts[i].time <= spec.restarts[i - 1].time + spec.restarts[i - 1].down)
            refuse("restart_at", "times do not rise");
    for (std::size_t i = 1; i < spec.signals.size(); ++i)
        if (spec.signals[i].time < spec.signals[i - 1].time) refuse("signals", "times do not rise");
    if (spec.program.empty()) refuse("program", "no program is given");
    if (spec.host_name.size() >= wire::kNameLength) refuse("host_name", "is longer than 63 characters");
    if (spec.tty.empty() && !spec.tty_aliases.empty()) refuse("tty_aliases", "there is no serial port");
    if (1 + spec.tty_aliases.size() + spec.i2c.size() + spec.cameras.size() > wire::kMaximumDevices)
        refuse("", "too many names of devices");
    if (!spec.network) return;
    place_of(*spec.network);
    if (spec.network->names.size() > wire::kMaximumHosts) refuse("network", "has too many names");
    for (const NetworkName& one : spec.network->names)
        if (one.name.size() >= sizeof wire::HostEntry::name) refuse("network", "has a name that is too long");
}

std::int64_t clock_error_of(const LinuxSpec& spec) {
    constexpr double kPartsOfPpm = static_cast<double>(wire::kClockUnit) / 1e6;
    return std::llround(spec.system_clock_ppm * kPartsOfPpm);
}

LinuxSpec parse_linux_spec(std::string_view text) {
    LinuxSpec spec;
    try {
        from_value(spec, parse_json(text), "linux");
    } catch (const std::invalid_argument& error) {
        throw InputError("", "linux program", error.what());
    }
    check(spec);
    return spec;
}

}  // namespace puckloop::linuxboard
