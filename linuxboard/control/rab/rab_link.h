#pragma once
// Keeps a range-and-bearing board busy in the background: one thread polls it for messages, one sends the
// robot's own message again and again.
//
// The board neither listens nor sends well while its I2C line is used (fact sheet 4.6), so:
//  * no poll while the own frame is on the air,
//  * the time between two frames varies by a tenth, so that two robots that collide once do not go on
//  colliding.
// A board that stops answering is reported once, asked once a second, and set up again when it is back.

#include "linuxboard/control/rab/rab_board.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace puckloop::control {

struct RabLinkSettings {
    double poll_period = 0.020;  ///< s
    double emit_period = 0.020;  ///< s, mean
    double start_wait = 0.3;     ///< s to wait for the board at the start: it boots in some 10 ms
    std::uint32_t seed = 1;      ///< of the variation of the emission period: the robot's id
};

struct RabLinkCounters {
    RabBoardCounters bus;
    unsigned long sent = 0;      ///< frames handed to the board
    unsigned long polls = 0;     ///< times the board was asked for a message
    unsigned long received = 0;  ///< messages read
    unsigned long dropped = 0;   ///< messages nobody took
    unsigned long setups = 0;    ///< times the board was set up, the first included
};

class RabLink {
  public:
    using Log = std::function<void(const std::string&)>;

    RabLink(RabBoard& board, Clock& clock, Log log, RabLinkSettings settings = {});
    ~RabLink() { stop(); }
    RabLink(const RabLink&) = delete;
    RabLink& operator=(const RabLink&) = delete;

    /// Sets the board up; false when it does not answer.
    bool initialise();
    /// Starts both threads.
    void start();
    /// Ends them; takes one period at most.
    void stop();

    /// What all emitters send from now on; empty: nothing.
    void say(std::optional<std::uint32_t> payload);
    /// What each emitter sends from now on.
    void say_each(const std::array<std::optional<std::uint32_t>, rab::kEmitters>& payloads);
    /// The messages since the last call, oldest first; 256 are kept.
    std::vector<RabPacket> take();
    RabLinkCounters counters() const;

    /// One step of the threads; the time of the next. Tests call these themselves.
    double poll_step();
    double emit_step();

  private:
    bool set_up();
    void watch_board();
    void run(double (RabLink::*step)());
    double varied_period();

    RabBoard& board_;
    Clock& clock_;
    Log log_;
    RabLinkSettings settings_;
    mutable std::mutex mutex_;
    std::array<std::optional<std::uint32_t>, rab::kEmitters> payloads_;
    std::vector<RabPacket> packets_;
    RabLinkCounters counters_;
    double quiet_until_ = 0;   // the own frame is on the air
    double repeat_range_ = 0;  // when to set the emission power again, 0: done
    double ask_again_ = 0;     // the board is away until then
    bool away_ = false;
    std::uint32_t variation_;
    std::atomic<bool> stopping_ = false;
    std::vector<std::thread> threads_;
};

}  // namespace puckloop::control
