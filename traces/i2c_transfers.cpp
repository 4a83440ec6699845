#include "traces/i2c_transfers.h"

#include <algorithm>

namespace puckloop::tools {

using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::TraceRow;

namespace {

bool is_request(I2cPhaseKind kind) {
    return kind == I2cPhaseKind::Start || kind == I2cPhaseKind::Write || kind == I2cPhaseKind::Read ||
           kind == I2cPhaseKind::Stop;
}

I2cStep::Kind kind_of_request(I2cPhaseKind kind) {
    switch (kind) {
    case I2cPhaseKind::Start:
        return I2cStep::Kind::Start;
    case I2cPhaseKind::Write:
        return I2cStep::Kind::Write;
    case I2cPhaseKind::Read:
        return I2cStep::Kind::Read;
    default:
        return I2cStep::Kind::Stop;
    }
}

/// A link of a bus is called after it: "robot0.i2c.linux" is one of the node "robot0.i2c".
bool is_of(const std::string& link, const std::string& bus) {
    return link.size() > bus.size() && link.starts_with(bus) && link[bus.size()] == '.';
}

}  // namespace

void I2cTransfers::add(const TraceRow& row, const I2cPhase& phase) {
    Link& link = links_[row.link];
    if (link.device) return;
    if (is_request(phase.kind)) {
        // The bus's notice that another master sends the same (cosim/i2c/i2c_shared.h).
        if (!link.open.empty() && row.from != link.open.front().master) return;
        if (is_of(row.link, row.from)) {
            link.device = true;
            return;
        }
        if (link.bus.empty()) link.bus = row.link.substr(0, row.link.rfind('.'));
        request(link, row, phase);
    } else if (!link.open.empty() && row.from != link.open.front().master) {
        link.bus = row.from;
        answer(link, row, phase);
    }
}

void I2cTransfers::request(Link& link, const TraceRow& row, const I2cPhase& phase) {
    // What was open before the newest request and has no answer by now gets none.
    if (row.time > link.requested)
        while (link.open.size() > 1)
            hand_over(link, I2cStep::End::Abandoned);
    link.requested = row.time;
    I2cStep step;
    step.kind = kind_of_request(phase.kind);
    step.byte = phase.byte;
    step.acknowledged = phase.ack != 0;
    step.start = phase.start;
    step.clock_period = phase.clock_period;
    step.known = row.time;
    step.fault = row.fault;
    step.master = row.from;
    step.bus = link.bus;
    step.link = row.link;
    link.open.push_back(step);
    if (link.open.front().kind == I2cStep::Kind::Stop) hand_over(link, I2cStep::End::Answered);
}

void I2cTransfers::answer(Link& link, const TraceRow& row, const I2cPhase& phase) {
    I2cStep& step = link.open.front();
    step.bus = link.bus;
    step.known = row.time;
    if (row.fault != cosim::FaultKind::None) step.fault = row.fault;
    step.start = std::max(step.start, phase.start);  // later where another transfer was waited for
    if (phase.kind == I2cPhaseKind::BusLost) return hand_over(link, I2cStep::End::Lost);
    step.start = phase.start;
    step.stretch = phase.stretch;
    step.byte = phase.byte;
    // A row of Data has no acknowledge: that is the master's, in its Read.
    if (phase.kind == I2cPhaseKind::Acknowledge) step.acknowledged = phase.ack != 0;
    hand_over(link, I2cStep::End::Answered);
    while (!link.open.empty() && link.open.front().kind == I2cStep::Kind::Stop)
        hand_over(link, I2cStep::End::Answered);
}

void I2cTransfers::hand_over(Link& link, I2cStep::End end) {
    I2cStep step = link.open.front();
    link.open.pop_front();
    step.end = step.kind == I2cStep::Kind::Stop ? I2cStep::End::Answered : end;
    take_(step);
}

void I2cTransfers::end() {
    for (auto& [name, link] : links_)
        while (!link.open.empty())
            hand_over(link, I2cStep::End::Abandoned);
}

}  // namespace puckloop::tools
