#include "linuxboard/control/session.h"

#include <algorithm>
#include <array>

namespace puckloop::control {

using namespace protocols;

namespace {

constexpr int kGarbledLimit = 3;  // so many bad records in a row: not noise, something is out of step
constexpr std::array<std::uint8_t, 1> kZero{0};
constexpr EpuckActuatorBytes kStop{};  // a record of zeros keeps the sides as far out of step as they are

}  // namespace

Session::Session(Transport& transport, Log log, std::function<bool()> interrupted, SessionTiming timing)
    : transport_(transport), log_(std::move(log)), interrupted_(std::move(interrupted)), timing_(timing) {}

/// Reads and drops until the line has been silent for `silence` (0: only what is already there).
std::size_t Session::discard(double silence) {
    std::array<std::uint8_t, 256> bytes{};
    std::size_t total = 0;
    while (const std::size_t count = transport_.read(bytes, transport_.now() + silence))
        total += count;
    counters_.stray_bytes += total;
    return total;
}

/// Fills `record` until it is full, its first byte does not come in time, or the line falls silent.
std::size_t Session::receive(std::span<std::uint8_t> record, double first_byte_until) {
    std::size_t have = 0;
    double until = first_byte_until;
    while (have < record.size()) {
        const std::size_t count = transport_.read(record.subspan(have), until);
        const double now = transport_.now();
        if (count == 0 && now >= until) break;
        if (count > 0) until = now + timing_.silence;
        have += count;
    }
    return have;
}

bool Session::accept(std::span<const std::uint8_t> record) {
    if (record.size() != kEpuckSensorBytes) {
        ++counters_.short_records;
        log_("sensor record of " + std::to_string(record.size()) + " bytes instead of 72, dropped");
        return false;
    }
    const EpuckSensors sensors = decode_sensors(record.first<kEpuckSensorBytes>());
    if (const std::string_view reason = why_implausible(sensors); !reason.empty()) {
        ++counters_.implausible;
        log_("sensor record dropped: " + std::string(reason));
        return false;
    }
    const double now = transport_.now();
    if (newest_) counters_.longest_gap = std::max(counters_.longest_gap, now - newest_time_);
    newest_ = sensors;
    newest_time_ = now;
    ++counters_.records;
    garbled_in_a_row_ = 0;
    return true;
}

bool Session::start(double give_up) {
    discard(0);
    log_("waking the PIC");
    std::array<std::uint8_t, 1 + kEpuckConfigurationBytes> hello{kEpuckWakeUp};
    const EpuckConfigurationBytes configuration = encode(EpuckConfiguration{});
    std::copy(configuration.begin(), configuration.end(), hello.begin() + 1);
    transport_.write(hello);
    EpuckSensorBytes record{};
    const std::size_t have = receive(record, transport_.now() + timing_.start_answer);
    if (have == 0) log_("no answer to the wake-up: the PIC is restarting, or was left inside a session");
    if (have > 0 && accept(std::span(record).first(have))) {
        log_("session started");
        return true;
    }
    return resync(give_up);
}

std::optional<EpuckSensors> Session::exchange(const EpuckActuators& actuators) {
    discard(0);
    const EpuckActuatorBytes frame = encode(actuators);
    EpuckSensorBytes record{};
    ++counters_.frames;
    transport_.write(std::span(frame).first(frame.size() - 1));
    const std::size_t early = transport_.read(record, transport_.now() + timing_.hold_back);
    if (early > 0) {
        ++counters_.slips;
        counters_.stray_bytes += early;
        log_("answer before the record's last byte was sent: the PIC holds surplus bytes");
        transport_.write(kStop);  // it has obeyed parts of two records: end that before all else
        lost_ = true;
        return std::nullopt;
    }
    transport_.write(std::span(frame).last(1));
    const double patience = actuators.ircom_enabled != 0 ? timing_.answer_to_word : timing_.answer;
    const std::size_t have = receive(record, transport_.now() + patience);
    if (have == 0) {
        ++counters_.no_answer;
        log_("no answer to actuator record " + std::to_string(counters_.frames));
        lost_ = true;
        return std::nullopt;
    }
    if (accept(std::span(record).first(have))) return newest_;
    lost_ = ++garbled_in_a_row_ >= kGarbledLimit;
    return std::nullopt;
}

/// Zeros, singly, at most a record of them, until the PIC answers. Proven: the answer was one whole record.
Session::Round Session::round_of_zeros() {
    EpuckSensorBytes record{};
    for (std::size_t sent = 0; sent < kEpuckActuatorBytes; ++sent) {
        transport_.write(kZero);
        const bool last = sent + 1 == kEpuckActuatorBytes;
        const std::size_t have =
            receive(record, transport_.now() + (last ? timing_.start_answer : timing_.step));
        if (have == 0) continue;
        const bool surplus = discard(timing_.silence / 2) > 0;
        return accept(std::span(record).first(have)) && !surplus ? Round::Proven : Round::Answered;
    }
    return Round::Silent;
}

bool Session::resync(double give_up) {
    ++counters_.resyncs;
    const double begun = transport_.now();
    log_("re-synchronising");
    discard(timing_.silence);
    double pause = timing_.pause_first;
    do {
        if (round_of_zeros() != Round::Silent && round_of_zeros() == Round::Proven) {
            lost_ = false;
            garbled_in_a_row_ = 0;
            const long milliseconds = static_cast<long>((transport_.now() - begun) * 1e3);
            log_("in step again after " + std::to_string(milliseconds) + " ms");
            return true;
        }
        transport_.sleep_until(transport_.now() + pause);
        pause = std::min(2 * pause, timing_.pause_last);
    } while (!interrupted_() && transport_.now() < give_up);
    return false;
}

void Session::end() {
    EpuckActuators farewell;
    farewell.reset = kEpuckEnd;
    transport_.write(encode(farewell));
}

}  // namespace puckloop::control
