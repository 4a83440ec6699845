#include "ends/live_end.h"

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <sys/prctl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>

namespace puckloop::exec {

namespace {

constexpr int kBitsOfFrame = 10;
/// What the simulation has not taken of what came from the partner; more stays with the partner.
constexpr std::size_t kUnpacedBlock = 4096;
constexpr auto kLookEvery = std::chrono::milliseconds(2);
constexpr auto kRetry = std::chrono::milliseconds(2);
/// What waits for a partner that does not read, in a paced run (91 s at 115200 baud) and in another.
constexpr std::size_t kPacedBacklog = 1 << 20, kUnpacedBacklog = 16 << 10;
/// A partner that has taken nothing for so long does not read.
constexpr auto kPatience = std::chrono::seconds(1);
/// At the end of a run: also one that reads slowly is not waited for any longer.
constexpr auto kLongestFarewell = std::chrono::seconds(5);
constexpr double kRatesDiffer = 0.02;

std::chrono::nanoseconds wall(cosim::Time time) {
    return std::chrono::nanoseconds(time / cosim::kNanosecond);
}

}  // namespace

std::string text_of(const EndLosses& losses, const std::string& partner) {
    return fmt::format("{} bytes from {:.3f} s on were lost: the program at {} did not read them",
                       losses.unread, cosim::to_seconds(losses.unread_since), partner);
}

LiveEnd::LiveEnd(const LiveOptions& options, const MakeStream& make)
    : options_(options), busy_(io_.get_executor()), timer_(io_), stream_(make(io_)), wall_now_(Clock::now()) {
    bit_period_ = period_of_partner();
    boost::asio::post(io_, [this] { await_bytes(); });
    // Signals are for the thread that runs the simulation.
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    thread_ = std::thread([this] { work(); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

LiveEnd::~LiveEnd() {
    io_.stop();
    thread_.join();
}

void LiveEnd::work() {
    prctl(PR_SET_TIMERSLACK, 1UL);  // a byte at 115200 baud lasts 87 us, the usual slack is 50
    try {
        io_.run();
    } catch (...) {
        const std::lock_guard lock(mutex_);
        error_ = std::current_exception();
    }
}

cosim::Time LiveEnd::period_of_partner() const {
    const double baud = stream_->baud().value_or(0);
    return baud > 0 ? static_cast<cosim::Time>(std::llround(1e12 / baud)) : 0;
}

/// Nothing in a run that is not paced: the line is then as fast as it can be.
LiveEnd::Clock::duration LiveEnd::duration_of_byte(cosim::Time bit_period) const {
    if (!options_.paced) return {};
    return wall(kBitsOfFrame * (bit_period != 0 ? bit_period : options_.bit_period));
}

bool LiveEnd::plugged() const {
    return stream_->there() && stream_->baud().value_or(1) > 0;
}

std::uint8_t LiveEnd::take() {
    const std::uint8_t value = ready_.front().value;
    ready_.pop_front();
    return value;
}

void LiveEnd::receive(std::uint8_t byte, bool /*clean*/, cosim::Time start) {
    const bool plugged_in = plugged();
    std::unique_lock lock(mutex_);
    if (!plugged_in) {
        ++losses_.unconnected;
        return;
    }
    const Clock::duration length = duration_of_byte(bit_period_);
    Byte out{byte, 0, {}, start};
    if (options_.paced) out.due = std::max(wall_now_ + wall(start - now_) + length, last_sent_ + length);
    if (!make_room(lock)) {
        losses_.unread_since = std::min(losses_.unread_since, start);
        ++losses_.unread;
        return;
    }
    last_sent_ = out.due;
    outgoing_.push_back(out);
    if (sending_) return;
    sending_ = true;
    boost::asio::post(io_, [this] { send_due(); });
}

/// Whether one byte more may wait for the partner; `lock`, of `mutex_`, is released while it waits for that.
bool LiveEnd::make_room(std::unique_lock<std::mutex>& lock) {
    if (options_.paced) return outgoing_.size() < kPacedBacklog;
    std::uint64_t taken = taken_;
    for (auto until = Clock::now() + kPatience; outgoing_.size() >= kUnpacedBacklog;) {
        if (!reads_ || Clock::now() >= until) return reads_ = false;
        lock.unlock();
        std::this_thread::sleep_for(kRetry);
        lock.lock();
        if (taken_ != taken) until = Clock::now() + kPatience;
        taken = taken_;
    }
    return reads_ = true;
}

/// The first `count` bytes that wait reach nobody; with `mutex_` held.
void LiveEnd::lose(std::size_t count) {
    if (count == 0) return;
    if (plugged()) {
        losses_.unread_since = std::min(losses_.unread_since, outgoing_.front().start);
        losses_.unread += count;
    } else {
        losses_.unconnected += count;
    }
    outgoing_.erase(outgoing_.begin(), outgoing_.begin() + static_cast<std::ptrdiff_t>(count));
}

EndLosses LiveEnd::losses() const {
    const std::lock_guard lock(mutex_);
    return losses_;
}

void LiveEnd::poll(cosim::Time now, cosim::Time /*listening_since*/) {
    now_ = now;
    wall_now_ = Clock::now();
    bit_period_ = period_of_partner();
    notice_rate();
    notice_loss();
    const std::lock_guard lock(mutex_);
    if (error_) std::rethrow_exception(error_);
    if (incoming_.empty() || incoming_.front().due > wall_now_) return;
    if (ready_.empty()) ready_at_ = now;
    for (; !incoming_.empty() && incoming_.front().due <= wall_now_; incoming_.pop_front())
        ready_.push_back(incoming_.front());
    boost::asio::post(io_, [this] { await_bytes(); });
}

void LiveEnd::notice_rate() {
    if (rate_noticed_ || bit_period_ == 0 || options_.bit_period == 0) return;
    const double ratio = static_cast<double>(bit_period_) / static_cast<double>(options_.bit_period);
    if (std::abs(ratio - 1) < kRatesDiffer) return;
    rate_noticed_ = true;
    fmt::print(
        stderr,
        "{}: a program has set {} to {:.0f} baud, the line is meant to have {:.0f}: bytes are sampled at "
        "those rates\n",
        options_.name, stream_->announcement(), 1e12 / static_cast<double>(bit_period_),
        1e12 / static_cast<double>(options_.bit_period));
    std::fflush(stderr);
}

void LiveEnd::notice_loss() {
    if (loss_noticed_) return;
    const cosim::Time since = losses().unread_since;
    if (since == cosim::kNever) return;
    loss_noticed_ = true;
    fmt::print(stderr,
               "{}: the program at {} does not read: bytes for it are lost from {:.3f} s on, and counted\n",
               options_.name, stream_->announcement(), cosim::to_seconds(since));
    std::fflush(stderr);
}

/// What the partner does not take in time is lost, and counted.
void LiveEnd::finish() {
    std::uint64_t taken = 0;
    const auto end = Clock::now() + kLongestFarewell;
    for (auto until = Clock::now() + kPatience;; std::this_thread::sleep_for(kRetry)) {
        const std::lock_guard lock(mutex_);
        if (error_) std::rethrow_exception(error_);
        if (taken_ != taken) until = Clock::now() + kPatience;
        taken = taken_;
        if (!outgoing_.empty() && Clock::now() < std::min(until, end)) continue;
        lose(outgoing_.size());
        break;
    }
    notice_loss();
}

void LiveEnd::await_bytes() {
    if (awaiting_) return;
    {
        const std::lock_guard lock(mutex_);
        if (!incoming_.empty() && !options_.paced) return;
    }
    awaiting_ = true;
    stream_->await_readable([this] {
        awaiting_ = false;
        take_in();
    });
}

/// Takes no more than a UART would have sent soon: the rest waits in the partner's own buffer.
void LiveEnd::take_in() {
    const Clock::duration length = duration_of_byte(period_of_partner());
    std::array<std::uint8_t, kUnpacedBlock> block;
    std::size_t room = block.size();
    if (options_.paced && length > Clock::duration::zero()) {
        const std::lock_guard lock(mutex_);
        const std::size_t most =
            std::min(block.size(), kFifo + static_cast<std::size_t>(kLookEvery / length));
        room = most > incoming_.size() ? most - incoming_.size() : 0;
    }
    const std::size_t got = room == 0 ? 0 : stream_->read({block.data(), room});
    if (room == 0) return;                           // poll() looks again once some have been taken
    const cosim::Time period = period_of_partner();  // it was set before the bytes were written
    if (plugged()) {
        const std::lock_guard lock(mutex_);
        for (std::size_t i = 0; i < got; ++i) {
            const Clock::time_point due = std::max(Clock::now(), line_free_in_);
            line_free_in_ = due + duration_of_byte(period);
            incoming_.push_back({block[i], period, options_.paced ? due : Clock::time_point{}});
        }
    }
    await_bytes();
}

/// Writes what is due and sets the timer for what is not.
void LiveEnd::send_due() {
    const Clock::time_point now = Clock::now();
    std::array<std::uint8_t, kUnpacedBlock> block;
    const std::size_t count = take_due(block, now);
    const std::size_t taken = count == 0 ? 0 : stream_->write({block.data(), count});
    const std::lock_guard lock(mutex_);
    taken_ += taken;
    // finish() may have given up what waited.
    outgoing_.erase(outgoing_.begin(),
                    outgoing_.begin() + static_cast<std::ptrdiff_t>(std::min(taken, outgoing_.size())));
    std::size_t left = std::min(count - taken, outgoing_.size());
    if (!plugged() || (options_.paced && !stream_->waits())) {
        lose(left);
        left = 0;
    }
    if (outgoing_.empty()) {
        sending_ = false;
        return;
    }
    timer_.expires_at(left > 0 ? now + kRetry : std::max(outgoing_.front().due, line_free_out_));
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (!error) send_due();
    });
}

/// The bytes that may be written now. `line_free_out_` runs ahead by what a FIFO lets out at once.
std::size_t LiveEnd::take_due(std::span<std::uint8_t> block, Clock::time_point now) {
    const Clock::duration length = duration_of_byte(period_of_partner());
    const std::lock_guard lock(mutex_);
    std::size_t count = 0;
    line_free_out_ = std::max(line_free_out_, now - static_cast<int>(kFifo - 1) * length);
    while (count < std::min(block.size(), outgoing_.size()) && outgoing_[count].due <= now &&
           line_free_out_ <= now) {
        block[count] = outgoing_[count].value;
        line_free_out_ += length;
        ++count;
    }
    return count;
}

}  // namespace puckloop::exec
