#include "tools/trace/lines.h"

#include "protocols/uart_sampling.h"

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

LineRenderer::LineRenderer(Emit emit)
    : emit_(std::move(emit)), transfers_([this](const I2cStep& step) { i2c(step); }) {}

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
    now_ = row.time;
    last_ = std::max(last_, row.time);
    if (const auto* frame = std::get_if<cosim::UartFrame>(&row.payload)) {
        uart(row, *frame);
    } else if (const auto* phase = std::get_if<cosim::I2cPhase>(&row.payload)) {
        transfers_.add(row, *phase);
    } else if (const auto* change = std::get_if<cosim::Signal>(&row.payload)) {
        signal(row, *change);
    } else {
        const auto& radio = std::get<cosim::RadioFrame>(row.payload);
        if (!keeps_from_arriving(row.fault))
            active(line(row.link, row.from, "on_air", Line::Kind::OnAir), radio.start,
                   radio.start + radio.duration);
    }
}

void LineRenderer::end() {
    transfers_.end();
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

void LineRenderer::i2c(const I2cStep& step) {
    if (step.fault != cosim::FaultKind::None && step.clock_period > 0)
        active(line(step.bus, "", "fault", Line::Kind::Fault), step.start,
               step.start + 9 * step.clock_period);
    if (step.end == I2cStep::End::Lost || step.clock_period <= 0) return;
    const auto [found, is_new] = buses_.try_emplace(step.bus);
    Wires& wires = found->second;
    if (is_new) {
        wires.scl = line(step.bus, "", "scl", Line::Kind::Scl);
        wires.sda = line(step.bus, "", "sda", Line::Kind::Sda);
    }
    shortest_ = std::min(shortest_, step.clock_period);
    if (step.kind != I2cStep::Kind::Stop) return i2c_byte(wires, step);
    const Time at = step.start, period = step.clock_period;
    if (!wires.held) event(at, wires.scl, 1);
    event(at + part(period, kHalf), wires.scl, -1);
    wires.held = false;
    active(wires.sda, at + part(period, kDataChanges), at + part(period, 12));
}

void LineRenderer::i2c_byte(Wires& wires, const I2cStep& step) {
    using Kind = I2cStep::Kind;
    const Time period = step.clock_period;
    Time at = step.start;
    if (step.kind == Kind::Start) {
        if (wires.held) event(at + part(period, 2), wires.scl, -1);
        active(wires.sda, at + part(period, 4), at + part(period, kFirstDataAfterStart));
        event(at + part(period, 6), wires.scl, 1);
    } else if (!wires.held) {
        event(at, wires.scl, 1);
    }
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

}  // namespace puckloop::tools
