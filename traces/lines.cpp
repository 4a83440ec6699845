#include "traces/lines.h"

#include "protocols/serial/uart_sampling.h"
#include "traces/can_frames.h"
#include "traces/received.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::tools {

using cosim::Time;

namespace {

constexpr int kParts = 16;  // of an I2C clock
constexpr int kHalf = 8, kDataChanges = 4, kFirstDataAfterStart = 7;

Time part(Time period, int n) {
    return period * n / kParts;
}

}  // namespace

std::string Line::full_name() const {
    if (kind == Kind::Uart) return fmt::format("{}/{}", scope, from);
    return from.empty() ? fmt::format("{}/{}", scope, name) : fmt::format("{}/{}/{}", scope, from, name);
}

const FaultMarks LineRenderer::kNoMarks;

LineRenderer::LineRenderer(Emit emit, const FaultMarks& marks)
    : emit_(std::move(emit)), marks_(marks), transfers_([this](const I2cStep& step) { i2c(step); }) {}

std::size_t LineRenderer::line(const std::string& scope, const std::string& from, const std::string& name,
                               Line::Kind kind) {
    const auto [found, is_new] =
        index_.try_emplace(fmt::format("{}\n{}\n{}", scope, from, name), lines_.size());
    if (is_new) {
        lines_.push_back({scope, from, name, kind});
        level_.push_back(false);
    }
    return found->second;
}

void LineRenderer::event(Time time, std::size_t line, int change) {
    time = std::max<Time>(time, 0);
    late_ = std::max(late_, now_ - time);
    last_ = std::max(last_, time);
    emit_(time, {line, change});
}

void LineRenderer::active(std::size_t line, Time begin, Time end) {
    if (end <= begin) return;
    event(begin, line, 1);
    event(end, line, -1);
}

void LineRenderer::add(const cosim::TraceRow& row) {
    while (const FaultMark* fault = alone_.next(row.time))
        mark(*fault);
    now_ = row.time;
    last_ = std::max(last_, row.time);
    if (const auto* frame = std::get_if<cosim::UartFrame>(&row.payload)) {
        uart(row, *frame);
    } else if (const auto* phase = std::get_if<cosim::I2cPhase>(&row.payload)) {
        transfers_.add(row, *phase);
    } else if (const auto* change = std::get_if<cosim::Signal>(&row.payload)) {
        signal(row, *change);
    } else if (const auto heard = can_on_bus(row)) {
        const std::size_t wire = line(heard->bus, "", "rx", Line::Kind::Can);
        shortest_ = std::min(shortest_, std::max<Time>(heard->bit, 1));
        for (const auto& [begin, end] : heard->dominant())
            active(wire, begin, end);
    } else if (const auto* sent = radio_on_air(row)) {
        const cosim::RadioFrame& radio = *sent;
        if (!keeps_from_arriving(row.fault))
            active(line(row.link, row.from, "on_air", Line::Kind::OnAir), radio.start,
                   radio.start + radio.duration);
    }
}

void LineRenderer::end() {
    transfers_.end();
    while (const FaultMark* fault = alone_.next(cosim::kNever))
        mark(*fault);
    for (const auto& [wire, since] : low_since_)
        event(std::max(since, last_), wire, -1);
    low_since_.clear();
}

void LineRenderer::uart(const cosim::TraceRow& row, const cosim::UartFrame& frame) {
    const std::size_t wire = line(row.link, row.from, "line", Line::Kind::Uart);
    if (frame.bit_period <= 0) return;
    if (row.fault != cosim::FaultKind::None)
        active(line(row.link, row.from, "fault", Line::Kind::Fault), frame.start,
               protocols::frame_end(frame));
    if (keeps_from_arriving(row.fault)) return;
    shortest_ = std::min(shortest_, frame.bit_period);
    const Time end = protocols::frame_end(frame);
    if (const auto low = low_since_.find(wire); low != low_since_.end()) {
        event(std::max(frame.start, low->second), wire, -1);
        low_since_.erase(low);
    }
    if ((frame.line & cosim::kLineRestsLow) != 0) {
        event(end, wire, 1);
        low_since_[wire] = end;
    }
    for (Time time = frame.start; time < end;) {
        const Time begin = time;
        while (time < end && !protocols::line_is_mark(frame, time))
            time = protocols::next_change(frame, time);
        active(wire, begin, time);
        while (time < end && protocols::line_is_mark(frame, time))
            time = protocols::next_change(frame, time);
    }
}

void LineRenderer::signal(const cosim::TraceRow& row, const cosim::Signal& signal) {
    const std::string name = row.signal.empty() ? fmt::format("signal{}", signal.id) : row.signal;
    const std::size_t pin = line(row.link, row.from, name, Line::Kind::Pin);
    if (signal.value != 0.0 && signal.value != 1.0) lines_[pin].logic = false;
    const bool level = signal.value != 0.0;
    if (level == level_[pin]) return;
    level_[pin] = level;
    event(row.time, pin, level ? 1 : -1);
}

/// A fault of no byte that is drawn.
void LineRenderer::mark(const FaultMark& mark) {
    constexpr Time kShown = 10 * cosim::kMicrosecond;
    now_ = std::max(now_, mark.time);
    Time end = mark.time + kShown;
    if (mark.low_from && mark.until && mark.what.find("bus busy") != std::string::npos) {
        // The bus was at rest, and a master had to wait.
        const Wires& wires = wires_of(mark.place);
        active(mark.kind == "scl" ? wires.scl : wires.sda, *mark.low_from, *mark.until);
        end = std::max(end, *mark.until);
    }
    active(line(mark.place, "", "fault", Line::Kind::Fault), mark.low_from.value_or(mark.time), end);
}

LineRenderer::Wires& LineRenderer::wires_of(const std::string& bus) {
    const auto [found, is_new] = buses_.try_emplace(bus);
    if (is_new) {
        found->second.scl = line(bus, "", "scl", Line::Kind::Scl);
        found->second.sda = line(bus, "", "sda", Line::Kind::Sda);
    }
    return found->second;
}

void LineRenderer::i2c(const I2cStep& step) {
    const auto marks = marks_.of_byte(step.bus, step.start);
    if ((step.fault != cosim::FaultKind::None || !marks.empty()) && step.clock_period > 0)
        active(line(step.bus, "", "fault", Line::Kind::Fault), step.start,
               step.start + 9 * step.clock_period + step.stretch);
    if (step.clock_period <= 0) return;
    if (step.end == I2cStep::End::Lost) {
        for (const FaultMark* mark : marks)
            if (mark->until) return i2c_lost(step, *mark);
        return;
    }
    Wires& wires = wires_of(step.bus);
    shortest_ = std::min(shortest_, step.clock_period);
    if (step.kind != I2cStep::Kind::Stop) return i2c_byte(wires, step);
    const Time at = step.start, period = step.clock_period;
    if (!wires.held) event(at, wires.scl, 1);
    event(at + part(period, kHalf), wires.scl, -1);
    wires.held = false;
    active(wires.sda, at + part(period, kDataChanges), at + part(period, 12));
}

/// The clock is low from the return value on.
Time LineRenderer::i2c_start(const Wires& wires, const I2cStep& step) {
    const Time at = step.start, period = step.clock_period, low = at + part(period, 6);
    if (wires.held) event(at + part(period, 2), wires.scl, -1);
    active(wires.sda, at + part(period, 4), at + part(period, kFirstDataAfterStart));
    event(low, wires.scl, 1);
    return low;
}

void LineRenderer::i2c_byte(Wires& wires, const I2cStep& step) {
    using Kind = I2cStep::Kind;
    const Time period = step.clock_period;
    Time at = step.start;
    if (step.kind == Kind::Start)
        i2c_start(wires, step);
    else if (!wires.held)
        event(at, wires.scl, 1);
    wires.held = true;
    for (int clock = 0; clock < 9; ++clock) {
        const bool high = clock < 8 ? (step.byte >> (7 - clock) & 1) != 0 : !step.acknowledged;
        const bool stretched = clock == (step.kind == Kind::Read ? 0 : 8);
        const bool first = clock == 0 && step.kind == Kind::Start;
        const Time end = at + period + (stretched ? step.stretch : 0);
        event(end - period + part(period, kHalf), wires.scl, -1);
        // SDA keeps its level into the low half of the next clock.
        if (!high)
            active(wires.sda, at + part(period, first ? kFirstDataAfterStart : kDataChanges),
                   end + part(period, clock == 8 ? 1 : kDataChanges));
        event(end, wires.scl, 1);
        at = end;
    }
}

/// Bits up to the one that was lost; then either another master has the bus and sends a STOP when it lets
/// go, or SDA is held low.
void LineRenderer::i2c_lost(const I2cStep& step, const FaultMark& mark) {
    Wires& wires = wires_of(step.bus);
    shortest_ = std::min(shortest_, step.clock_period);
    const Time period = step.clock_period;
    const auto is_lost = [&](int bit) {
        if (mark.bit) return bit == *mark.bit;
        const Time looked = step.start + (7 - bit) * period + period / 2;
        return (step.byte >> bit & 1) != 0 && looked >= mark.low_from.value_or(0) && looked < *mark.until;
    };
    int lost = 7;
    while (lost > 0 && !is_lost(lost))
        --lost;
    if (step.kind == I2cStep::Kind::Start)
        i2c_start(wires, step);
    else if (!wires.held)
        event(step.start, wires.scl, 1);
    wires.held = false;
    Time at = step.start;
    for (int bit = 7; bit >= lost; --bit, at += period) {
        const bool first = bit == 7 && step.kind == I2cStep::Kind::Start;
        event(at + part(period, kHalf), wires.scl, -1);
        if (bit > lost) {
            if ((step.byte >> bit & 1) == 0)
                active(wires.sda, at + part(period, first ? kFirstDataAfterStart : kDataChanges),
                       at + period + part(period, kDataChanges));
            event(at + period, wires.scl, 1);
        } else if (mark.bit) {  // the other one's 0, its clock held, its STOP
            const Time stop = std::max(*mark.until, at + 2 * period);
            event(at + period, wires.scl, 1);
            event(stop - part(period, 10), wires.scl, -1);
            active(wires.sda, at + part(period, first ? kFirstDataAfterStart : kDataChanges),
                   stop - part(period, kDataChanges));
        } else {
            active(wires.sda, std::max(mark.low_from.value_or(step.start), step.start), *mark.until);
        }
    }
}

}  // namespace puckloop::tools
