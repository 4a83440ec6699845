#include "cosim/can/can_station.h"

#include <algorithm>

namespace puckloop::cosim {

using protocols::CanError;
using protocols::kDominant;
using protocols::kRecessive;

namespace {
constexpr int kIntegration = 11, kFlag = 6, kDelimiter = 8, kIntermission = 3, kSuspend = 8;
constexpr int kRecoveries = 128;
}  // namespace

// ---- taking part

void CanStation::join(const CanTiming& timing, bool listens, Time now, Time quiet_since, unsigned tec,
                      unsigned rec) {
    state_ = {};
    state_.timing = timing;
    state_.listens = listens;
    state_.tec = static_cast<std::uint16_t>(tec);
    state_.rec = static_cast<std::uint16_t>(rec);
    if (bus_off())
        state_.phase = state_.next = Phase::BusOff;
    else if (now - quiet_since >= kIntegration * timing.bit)
        state_.phase = state_.next = Phase::Idle;
    else
        state_.phase = state_.next = Phase::Integrating;
    if (state_.phase != Phase::Idle) state_.next_bit = now;
}

void CanStation::leave() {
    state_ = {};
}

bool CanStation::may_leave() const {
    return !busy();
}

void CanStation::offer(const CanOffer& offer, Time now) {
    if (state_.listens) return;
    state_.replaced = true;
    offered_ = offer;
    state_.pending = true;
    if (state_.phase == Phase::Idle) state_.next_bit = now;
}

bool CanStation::withdraw() {
    state_.pending = false;
    const bool in_frame = state_.phase == Phase::Frame && (state_.sends || state_.lost);
    const bool in_error =
        busy() && state_.phase != Phase::Frame && state_.reports && (state_.was_sender || state_.lost);
    if (in_frame || in_error) {
        state_.once = true;
        return false;
    }
    if (state_.phase == Phase::Idle) state_.next_bit = kNever;
    return true;
}

// ---- the bit clock

Time CanStation::next_event() const {
    return state_.sample_due ? state_.next_sample : state_.next_bit;
}

void CanStation::begin_bit(Time now) {
    State& state = state_;
    if (state.phase == Phase::Idle)
        start(now);
    else if (state.next != state.phase)
        enter_next(now);
    if (state.phase == Phase::Idle) {
        state.next_bit = state.next_sample = kNever;
        state.sample_due = state.low = false;
        return;
    }
    state.next_sample = now + state.timing.sample;
    state.next_bit = now + state.timing.bit;
    state.sample_due = true;
    state.low = false;
    if (state.phase == Phase::Frame)
        state.low = state.sends ? sending_.bits[state.index] == kDominant : state.acknowledges;
    if (state.phase == Phase::Flag) state.low = state.active_flag;
    state.acknowledges = false;
}

void CanStation::start(Time now) {
    if (!state_.pending) return;
    begin_frame(now, false);
    sending_ = offered_;
    state_.sends = true;
    state_.once = state_.replaced = false;
}

void CanStation::begin_frame(Time now, bool may_join) {
    State& state = state_;
    state.phase = state.next = Phase::Frame;
    state.reader = {};
    state.frame_start = now;
    state.index = 0;
    state.may_join = may_join;
    state.sends = state.lost = state.won = state.acknowledges = false;
    state.reports = state.overload = state.was_sender = state.suspends = false;
    state.low = false;
    state.next_sample = now + state.timing.sample;
    state.next_bit = now + state.timing.bit;
    state.sample_due = state.synchronised = true;
}

void CanStation::fall(Time now) {
    const State& state = state_;
    if (state.phase == Phase::Off) return;
    const bool open = state.phase == Phase::Idle || state.next == Phase::Idle;
    const bool suspended = !open && (state.phase == Phase::Suspend || state.next == Phase::Suspend);
    const bool last_of_intermission = state.phase == Phase::Intermission && state.count + 1 >= kIntermission;
    if (open || suspended || last_of_intermission) return begin_frame(now, !suspended);
    synchronise(now);
}

void CanStation::synchronise(Time now) {
    State& state = state_;
    if (!state.was_recessive || state.synchronised) return;
    if (state.sample_due) {
        if (state.low) return;  // its own edge came first
        const Time late = std::min(now - (state.next_bit - state.timing.bit), state.timing.jump);
        state.next_bit += late;
        state.next_sample += late;
    } else {
        state.next_bit -= std::min(state.next_bit - now, state.timing.jump);
    }
    state.synchronised = true;
}

// ---- samples

std::optional<CanNews> CanStation::sample(bool level) {
    state_.sample_due = state_.synchronised = false;
    state_.was_recessive = level == kRecessive;
    take_sample(level);
    return conclude();
}

void CanStation::take_sample(bool level) {
    State& state = state_;
    const auto count_recessive = [&](int most, Phase then) {
        state.count = level == kRecessive ? static_cast<std::uint16_t>(state.count + 1) : std::uint16_t{0};
        if (state.count == most) state.next = then;
    };
    switch (state.phase) {
    case Phase::Off:
    case Phase::Idle:
        break;
    case Phase::Integrating:
        count_recessive(kIntegration, Phase::Idle);
        break;
    case Phase::Frame:
        sample_frame(level);
        break;
    case Phase::Flag:
        sample_flag(level);
        break;
    case Phase::Delimiter:
        sample_delimiter(level);
        break;
    case Phase::Intermission:
        if (level == kDominant) return begin_overload();
        count_recessive(kIntermission, state.suspends ? Phase::Suspend : Phase::Idle);
        break;
    case Phase::Suspend:
        count_recessive(kSuspend, Phase::Idle);
        break;
    case Phase::BusOff:
        sample_bus_off(level);
        break;
    }
}

void CanStation::sample_frame(bool level) {
    State& state = state_;
    const CanError error = state.reader.take(level);
    if (state.reader.taken() == 1) {
        if (level == kRecessive) {  // no start of frame
            if (state.sends) return fail(CanError::Bit);
            state.next = Phase::Idle;
            return;
        }
        if (state.may_join && state.pending && !state.sends) {
            sending_ = offered_;
            state.sends = true;
            state.once = state.replaced = false;
        }
    }
    if (state.sends) {
        sample_sent(level, error);
        if (state.next != Phase::Frame || state.sends) {
            if (state.next == Phase::Frame && state.reader.ended()) state.next = Phase::Intermission;
            return;
        }
    }
    if (state.reader.ended()) {  // a dominant last bit only delays the next frame
        state.next = Phase::Intermission;
        if (level == kDominant) begin_overload();
        return;
    }
    if (error != CanError::None) return fail(error);
    state.acknowledges = state.reader.acknowledges() && !state.listens;
}

void CanStation::sample_sent(bool level, CanError error) {
    State& state = state_;
    const int index = state.index++;
    const bool sent = sending_.bits[index];
    if (index == sending_.bits.acknowledge()) {
        if (level == kRecessive) fail(CanError::Acknowledge);
        return;
    }
    if (level == sent) {
        state.won = index == sending_.bits.arbitration;
        return;
    }
    const bool may_lose = index <= sending_.bits.arbitration && sent == kRecessive;
    if (!may_lose) return fail(CanError::Bit);
    if (error == CanError::Stuff) return fail(error, false);
    state.sends = false;
    state.lost = true;
}

void CanStation::sample_flag(bool level) {
    State& state = state_;
    if (state.active_flag) {
        if (++state.count == kFlag) state.next = Phase::Delimiter;
        return;
    }
    state.run = level == state.run_level ? static_cast<std::uint8_t>(state.run + 1) : std::uint8_t{1};
    state.run_level = level;
    if (level == kDominant && state.unpunished) {
        state.unpunished = false;
        punish(true, 8);
    }
    if (state.run == kFlag) state.next = Phase::Delimiter;
    if (bus_off()) state.next = Phase::BusOff;
}

void CanStation::sample_delimiter(bool level) {
    State& state = state_;
    const bool first = std::exchange(state.after_flag, false);
    if (level == kRecessive) {
        if (++state.count == kDelimiter) state.next = Phase::Intermission;
        return;
    }
    if (state.count > 0) {
        if (state.count + 1 == kDelimiter) return begin_overload();
        return fail(CanError::Form);
    }
    constexpr int kPatience = 8;
    if (first && !state.was_sender && !state.overload) punish(false, 8);
    if (++state.run % kPatience == 0) punish(state.was_sender, 8);
    if (bus_off()) state.next = Phase::BusOff;
}

void CanStation::sample_bus_off(bool level) {
    State& state = state_;
    if (state.bits <= kErrorBits) ++state.bits;
    state.run = level == kRecessive ? static_cast<std::uint8_t>(state.run + 1) : std::uint8_t{0};
    if (state.run < kIntegration) return;
    state.run = 0;
    if (++state.count == kRecoveries) state.next = Phase::Idle;
}

// ---- errors

void CanStation::punish(bool sender, int step) {
    if (state_.listens) return;
    constexpr int kMostReceive = 255;
    if (sender)
        state_.tec = static_cast<std::uint16_t>(state_.tec + step);
    else
        state_.rec = static_cast<std::uint16_t>(std::min(state_.rec + step, kMostReceive));
}

void CanStation::fail(CanError error, bool counts) {
    State& state = state_;
    if (state.phase == Phase::Frame) {
        state.was_sender = state.sends;
        state.error_at = static_cast<std::uint8_t>(state.reader.taken() - 1);
        state.error = error;
    }
    state.reports = true;
    state.overload = false;
    const bool was_passive = passive();
    state.active_flag = !was_passive && !state.listens;
    state.unpunished = was_passive && state.was_sender && error == CanError::Acknowledge;
    if (counts && !state.unpunished) punish(state.was_sender, state.was_sender ? 8 : 1);
    state.suspends = state.was_sender && passive();
    state.next = bus_off() ? Phase::BusOff : Phase::Flag;
}

void CanStation::begin_overload() {
    State& state = state_;
    state.overload = true;
    state.active_flag = !state.listens;
    state.next = Phase::Flag;
}

// ---- from phase to phase

CanNews CanStation::news(CanNews::What what) const {
    const State& state = state_;
    CanNews news;
    news.what = what;
    news.start = state.frame_start;
    news.tag = sending_.tag;
    news.lost = state.lost;
    news.gone = state.once && what != CanNews::What::Sent;
    if (what == CanNews::What::Error || what == CanNews::What::BusOff) {
        news.sender = state.was_sender;
        news.error = state.error;
        news.position = state.error_at;
        if (news.sender) news.frame = sending_.frame;
    } else if (what == CanNews::What::Sent) {
        news.frame = sending_.frame;
    } else {
        news.frame = state.reader.frame();
    }
    return news;
}

CanNews CanStation::frame_ended() {
    State& state = state_;
    const CanNews reported = news(state.sends ? CanNews::What::Sent : CanNews::What::Received);
    if (state.sends) {
        if (!state.replaced) state.pending = false;
        if (state.tec > 0) --state.tec;
        state.suspends = passive();
    } else if (!state.listens && state.rec > 0) {
        state.rec = static_cast<std::uint16_t>(std::min<unsigned>(state.rec - 1u, kMostActive));
    }
    state.once = false;
    return reported;
}

std::optional<CanNews> CanStation::conclude() {
    State& state = state_;
    const bool ends = state.next == Phase::Intermission || state.overload;
    if (state.phase == Phase::BusOff && state.next == Phase::Idle) {
        state.tec = state.rec = 0;
        state.reports = false;
        return news(CanNews::What::Recovered);
    }
    if (state.next == state.phase) {
        if (state.phase != Phase::BusOff || !state.reports || state.bits < kErrorBits) return std::nullopt;
    } else if (state.phase == Phase::Frame && state.reader.ended() && ends) {
        return frame_ended();
    } else if (state.phase != Phase::Delimiter || !state.reports || !ends) {
        return std::nullopt;
    }
    const CanNews reported =
        news(state.phase == Phase::BusOff ? CanNews::What::BusOff : CanNews::What::Error);
    state.reports = state.once = false;
    return reported;
}

void CanStation::enter_next(Time now) {
    State& state = state_;
    state.phase = state.next;
    state.count = state.bits = 0;
    state.run = 0;
    state.run_level = kRecessive;
    state.after_flag = state.phase == Phase::Delimiter;
    if (state.phase == Phase::Idle) start(now);
}

Time CanStation::earliest_news(Time now, bool stirs) const {
    const State& state = state_;
    const Time bit = state.timing.bit;
    // Edges of others may shorten the bits until then, a few times.
    constexpr int kMostEdges = 3;
    const auto in = [&](int bits) {
        const Time moved = bits > 0 ? kMostEdges * state.timing.jump : 0;
        return std::max(state.next_bit, state.next_bit + bits * bit - moved);
    };
    const Time by_others = state.pending || stirs ? now + kErrorBits * bit : kNever;
    const int unsampled = state.sample_due ? 1 : 0;
    const bool over = state.next != state.phase;
    switch (state.phase) {
    case Phase::Off:
        return kNever;
    case Phase::Idle:
    case Phase::Integrating:
    case Phase::Intermission:
    case Phase::Suspend:
        return by_others;
    case Phase::Frame:
        if (over) return state.reader.ended() ? by_others : in(kErrorBits);
        return in(std::min(state.reader.left() - unsampled, kErrorBits));
    case Phase::Flag: {
        const int done = state.active_flag ? state.count : state.run;
        return in(over ? kDelimiter : kFlag - done - unsampled + kDelimiter);
    }
    case Phase::Delimiter:
        return over ? by_others : in(kDelimiter - state.count - unsampled);
    case Phase::BusOff:
        if (over) return by_others;
        return in(state.reports
                      ? std::max(0, kErrorBits - state.bits - unsampled)
                      : std::max(0, (kRecoveries - state.count) * kIntegration - state.run - unsampled));
    }
    return now;
}

}  // namespace puckloop::cosim
