#pragma once
// A UART end whose partner has a clock of its own, and the line to it at the pace of a wire: in a run paced
// by the wall clock no byte reaches the partner, or comes from it, sooner after the one before than its ten
// bit times, however unevenly simulated time goes. A thread of its own does the waiting and all I/O.
//
// Bytes to the partner leave when their stop bit is over. If the thread itself comes late, at most kFifo
// bytes go out together, as from the FIFO of a UART.
//
// A partner that does not read: a paced run cannot wait for it. What finds no room is lost, as at a serial
// port (a pty: once the kernel's buffer is full; TCP: once 1 MiB waits behind the kernel's), counted, and
// reported when it begins. A run that is not paced waits for a partner as long as that takes something every
// second.

#include "ends/host_stream.h"
#include "ends/uart_end.h"

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace puckloop::exec {

class LiveEnd final : public UartEnd {
  public:
    using MakeStream = std::function<std::unique_ptr<HostStream>(boost::asio::io_context&)>;
    static constexpr std::size_t kFifo = 16;

    LiveEnd(const LiveOptions& options, const MakeStream& make);
    ~LiveEnd() override;

    cosim::Time next() const override { return ready_.empty() ? cosim::kNever : ready_at_; }
    cosim::Time next_bit_period() const override { return ready_.front().bit_period; }
    std::uint8_t take() override;
    cosim::Time bit_period() const override { return bit_period_; }
    void receive(std::uint8_t byte, bool clean, cosim::Time start) override;
    void poll(cosim::Time now, cosim::Time listening_since) override;
    bool live() const override { return true; }
    std::string announcement() const override { return stream_->announcement(); }
    void finish() override;
    EndLosses losses() const override;

  private:
    using Clock = std::chrono::steady_clock;
    struct Byte {
        std::uint8_t value = 0;
        cosim::Time bit_period = 0;  ///< 0: the line's own
        Clock::time_point due;       ///< not before this on the wall clock
        cosim::Time start = 0;       ///< of its start bit, simulated
    };

    cosim::Time period_of_partner() const;
    Clock::duration duration_of_byte(cosim::Time bit_period) const;
    bool plugged() const;
    void notice_rate();
    void notice_loss();
    bool make_room(std::unique_lock<std::mutex>& lock);
    void lose(std::size_t count);
    void work();
    // On the I/O thread.
    void await_bytes();
    void take_in();
    void send_due();
    std::size_t take_due(std::span<std::uint8_t> block, Clock::time_point now);

    LiveOptions options_;
    boost::asio::io_context io_;
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> busy_;
    boost::asio::steady_timer timer_;
    std::unique_ptr<HostStream> stream_;
    std::thread thread_;

    // The simulation's side.
    std::deque<Byte> ready_;  ///< from the partner, to be begun now
    cosim::Time ready_at_ = 0;
    cosim::Time bit_period_ = 0;  ///< of the partner
    cosim::Time now_ = 0;         ///< simulated, at `wall_now_`
    Clock::time_point wall_now_;
    Clock::time_point last_sent_;  ///< when the byte queued last is due
    bool rate_noticed_ = false, loss_noticed_ = false;
    bool reads_ = true;  ///< the partner, as far as a run that is not paced has waited for it

    mutable std::mutex mutex_;  ///< of what follows
    std::deque<Byte> incoming_, outgoing_;
    bool sending_ = false;     ///< the timer runs
    std::uint64_t taken_ = 0;  ///< bytes that the partner has taken
    EndLosses losses_;
    std::exception_ptr error_;

    // The I/O thread's.
    bool awaiting_ = false;
    Clock::time_point line_free_in_, line_free_out_;
};

}  // namespace puckloop::exec
