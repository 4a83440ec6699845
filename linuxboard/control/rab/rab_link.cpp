#include "linuxboard/control/rab/rab_link.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace puckloop::control {

using namespace rab;

namespace {

constexpr std::size_t kKept = 256;
constexpr double kFrameMargin =
    0.0007;                             // s from the command to the first chip and the silence after the last
constexpr double kBoot = 0.25;          // s after which no board boots any more
constexpr double kBetweenTries = 0.02;  // s
constexpr double kAskPeriod = 1.0;      // s between questions to a board that is away
constexpr int kAway = 5;                // operations failed in a row
constexpr double kVariation = 0.1;      // of the emission period
constexpr std::uint32_t kMultiplier = 1664525;  // Numerical Recipes' linear congruential generator
constexpr std::uint32_t kIncrement = 1013904223;
constexpr double kTwoTo32 = 4294967296.0;

}  // namespace

RabLink::RabLink(RabBoard& board, Clock& clock, Log log, RabLinkSettings settings)
    : board_(board), clock_(clock), log_(std::move(log)), settings_(settings), variation_(settings.seed) {}

bool RabLink::set_up() {
    if (!board_.initialise()) return false;
    ++counters_.setups;
    repeat_range_ = clock_.now() + kBoot;
    return true;
}

bool RabLink::initialise() {
    const double give_up = clock_.now() + settings_.start_wait;
    while (!set_up()) {
        if (clock_.now() >= give_up) return false;
        clock_.sleep_until(clock_.now() + kBetweenTries);
    }
    return true;
}

void RabLink::start() {
    stopping_ = false;
    threads_.emplace_back([this] { run(&RabLink::poll_step); });
    threads_.emplace_back([this] { run(&RabLink::emit_step); });
}

void RabLink::stop() {
    stopping_ = true;
    for (std::thread& thread : threads_)
        thread.join();
    threads_.clear();
}

void RabLink::run(double (RabLink::*step)()) {
    while (!stopping_)
        clock_.sleep_until((this->*step)());
}

void RabLink::say(std::optional<std::uint32_t> payload) {
    const std::scoped_lock lock(mutex_);
    payloads_.fill(payload);
}

void RabLink::say_each(const std::array<std::optional<std::uint32_t>, kEmitters>& payloads) {
    const std::scoped_lock lock(mutex_);
    payloads_ = payloads;
}

std::vector<RabPacket> RabLink::take() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(packets_, {});
}

RabLinkCounters RabLink::counters() const {
    const std::scoped_lock lock(mutex_);
    RabLinkCounters counters = counters_;
    counters.bus = board_.counters();
    return counters;
}

/// After a failed operation, or before one: is the board away, or back?
void RabLink::watch_board() {
    if (!away_ && board_.failed_in_a_row() >= kAway) {
        away_ = true;
        ask_again_ = clock_.now() + kAskPeriod;
        log_("the range-and-bearing board does not answer any more: " +
             std::string(std::strerror(board_.last_error())));
    } else if (away_ && clock_.now() >= ask_again_) {
        ask_again_ = clock_.now() + kAskPeriod;
        if (!set_up()) return;
        away_ = false;
        log_("the range-and-bearing board answers again");
    }
}

double RabLink::poll_step() {
    const double begun = clock_.now();
    for (int message = 0; message < kQueue; ++message) {
        const std::scoped_lock lock(mutex_);  // for one message: the sender may come in between
        if (away_) watch_board();
        if (away_) break;
        if (clock_.now() < quiet_until_) return std::max(quiet_until_, begun);
        RabPacket packet;
        ++counters_.polls;
        const RabPoll found = board_.poll(packet);
        if (found == RabPoll::Failed) watch_board();
        if (found != RabPoll::Message) break;
        ++counters_.received;
        if (packets_.size() < kKept) {
            packets_.push_back(packet);
        } else {
            ++counters_.dropped;
        }
    }
    return begun + settings_.poll_period;
}

double RabLink::emit_step() {
    const double begun = clock_.now();
    const std::scoped_lock lock(mutex_);
    const bool anything = std::any_of(payloads_.begin(), payloads_.end(), [](auto& one) { return one; });
    if (away_ || !anything) return begun + settings_.emit_period;
    if (repeat_range_ > 0 && begun >= repeat_range_ && board_.repeat_range()) repeat_range_ = 0;
    if (board_.send_each(payloads_)) {
        ++counters_.sent;
        quiet_until_ = clock_.now() + frame_seconds(board_.settings().bytes) + kFrameMargin;
    } else {
        watch_board();
    }
    return begun + varied_period();
}

double RabLink::varied_period() {
    variation_ = kMultiplier * variation_ + kIncrement;
    return settings_.emit_period * (1 + kVariation * (2.0 * variation_ / kTwoTo32 - 1));
}

}  // namespace puckloop::control
