#pragma once
// What is around a bus under test, at random: two masters, one of them a device too, a board behind a port,
// ground sensor and turret. What each does next follows from what the bus sent.

#include "base/random.h"
#include "cosim/i2c/i2c_bus.h"
#include "cosim/i2c/i2c_shared.h"
#include "emu/i2c_devices/bus_node.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::tests {

using namespace cosim;

inline constexpr PortIndex kMasters = 2, kMainBoard = 3, kWorld = 4;
inline constexpr Time kPeriod = 10 * kMicrosecond;

/// Masters, board and world; may be copied, and the copy given another future.
class Outside {
  public:
    enum class Masters { Wild, Sane };

    /// Sane masters say nothing while they wait for an answer, unless they give the transfer up.
    /// `world`: the bus's port of this name.
    explicit Outside(std::uint64_t seed, Masters masters = Masters::Wild, PortIndex world = kWorld)
        : sane_(masters == Masters::Sane), world_(world), random_(seed, "outside") {
        for (PortIndex master = 0; master < kMasters; ++master)
            begin(master, pick(200 * kMicrosecond));
    }

    /// The messages before `until`, in order of time.
    std::vector<Message> before(Time until) {
        std::stable_sort(coming_.begin(), coming_.end(),
                         [](const Message& a, const Message& b) { return a.time < b.time; });
        const auto end = std::find_if(coming_.begin(), coming_.end(),
                                      [until](const Message& message) { return message.time >= until; });
        std::vector<Message> inbox(coming_.begin(), end);
        coming_.erase(coming_.begin(), end);
        for (const Message& message : inbox)
            if (const auto* phase = std::get_if<I2cPhase>(&message.payload); phase && message.port < kMasters)
                asked_[message.port] = phase->kind == I2cPhaseKind::Stop ? kNever : phase->start;
        return inbox;
    }
    void react(const std::vector<Message>& sent, Time now) {
        for (const Message& message : sent) {
            const auto* phase = std::get_if<I2cPhase>(&message.payload);
            if (phase == nullptr) continue;
            const Time at = std::max(message.time, now);
            if (message.port < kMasters)
                go_on(message.port, *phase, at);
            else
                board(message.port, *phase, at);
        }
        if (random_.below(sane_ ? 400 : 4) == 0)
            coming_.push_back({now + pick(kMillisecond), world_,
                               Signal{static_cast<std::uint16_t>(random_.below(6)),
                                      static_cast<double>(random_.below(1000))}});
    }

    /// From `now` on others act: what is still to come comes earlier or later, and what follows is drawn
    /// again.
    void diverge(std::uint64_t seed, Time now) {
        random_ = RandomStream(seed, "others");
        std::map<PortIndex, Time> shifts;
        for (Message& message : coming_) {
            auto& shift =
                shifts.try_emplace(message.port, pick(100 * kMicrosecond) - 50 * kMicrosecond).first->second;
            message.time = std::max(now, message.time + shift);
            if (auto* phase = std::get_if<I2cPhase>(&message.payload); phase && message.port < kMasters)
                phase->start = message.time;
        }
    }

    int stops_seen = 0;  ///< by the device that is a master too

  private:
    Time pick(Time most) { return 1 + static_cast<Time>(random_.below(static_cast<std::uint64_t>(most))); }
    void send(PortIndex port, I2cPhaseKind kind, std::uint8_t byte, Time at) {
        send(port, kind, byte, at, kind != I2cPhaseKind::Acknowledge);
    }
    void send(PortIndex port, I2cPhaseKind kind, std::uint8_t byte, Time at, std::uint8_t ack) {
        I2cPhase phase{.kind = kind, .byte = byte, .ack = ack, .start = at, .clock_period = kPeriod};
        coming_.push_back({at, port, phase});
    }
    /// Clocks out of step, wild ones of no number that there is.
    std::uint8_t loose_clocks() {
        if (!sane_ && random_.below(4) == 0) return static_cast<std::uint8_t>(random_.below(kMostI2cAck + 1));
        return LooseClocks{static_cast<int>(random_.below(9)), random_.below(2) == 0 ? 8 : 9}.packed();
    }
    void begin(PortIndex master, Time at) {
        constexpr std::uint8_t kAddresses[] = {0x60, 0x61, 0x20, 0x33};
        const auto address = kAddresses[random_.below(4)];
        send(master, I2cPhaseKind::Start, static_cast<std::uint8_t>(address << 1 | random_.below(2)), at);
    }
    void go_on(PortIndex master, const I2cPhase& answer, Time now) {
        if (sane_) {
            const auto own = [master](const Message& message) { return message.port == master; };
            if (asked_[master] == kNever) return;
            for (const Message& message : coming_)
                if (own(message) && message.time <= now) return;  // it gives up before
            std::erase_if(coming_, own);
        }
        const Time at = now + (random_.below(2) == 0 ? 1 : pick(50 * kMicrosecond));
        const bool refused = answer.kind == I2cPhaseKind::BusLost || answer.ack == 0;
        const std::uint64_t what = random_.below(refused ? 2 : 16);
        if (what < 2) {
            if (answer.kind != I2cPhaseKind::BusLost) send(master, I2cPhaseKind::Stop, 0, at);
            begin(master, at + pick(500 * kMicrosecond));
        } else if (what == 2) {
            begin(master, at);
        } else if (answer.kind == I2cPhaseKind::Data && what == 4) {  // and goes on, against a NACK
            send(master, I2cPhaseKind::Acknowledge, 0, at);
            send(master, I2cPhaseKind::Write, 0xA5, at + 1);
        } else if (what == 12) {  // a STOP or START follows
            send(master, I2cPhaseKind::Acknowledge, 0, at, kNoByteFollows);
        } else if (what == 13) {
            send(master, I2cPhaseKind::Data, static_cast<std::uint8_t>(random_.below(256)), at,
                 loose_clocks());
        } else if (answer.kind == I2cPhaseKind::Data || what == 3) {
            send(master, I2cPhaseKind::Read, 0, at);
        } else {
            send(master, I2cPhaseKind::Write, static_cast<std::uint8_t>(random_.below(256)), at);
        }
        if (random_.below(25) == 0) {  // loses patience
            send(master, I2cPhaseKind::Stop, 0, at + (sane_ ? kPeriod : 0) + pick(kMillisecond));
            begin(master, at + 2 * kMillisecond + pick(kMillisecond));
        }
    }
    void board(PortIndex port, const I2cPhase& phase, Time now) {
        stops_seen += port == kMainBoard && phase.kind == I2cPhaseKind::Stop;
        const bool states = phase.kind == I2cPhaseKind::Acknowledge && phase.ack == 0;
        if (phase.kind == I2cPhaseKind::Stop || states) return;
        I2cPhase answer = phase;
        answer.kind = phase.kind == I2cPhaseKind::Read ? I2cPhaseKind::Data : I2cPhaseKind::Acknowledge;
        answer.ack = random_.below(5) != 0;
        answer.byte = static_cast<std::uint8_t>(random_.below(256));
        const Time stretch = random_.below(6) == 0 ? pick(2 * kMillisecond) : 0;
        coming_.push_back({std::max(now, phase.start + 8 * kPeriod + stretch), port, answer});
    }

    bool sane_;
    PortIndex world_;
    RandomStream random_;
    std::vector<Message> coming_;
    Time asked_[kMasters] = {kNever, kNever};  ///< start of the phase that was said last
};

/// With its log in the file `log`; empty: none. Without `main_board` only the first board answers.
inline std::unique_ptr<Node> bus(const std::string& log, bool main_board = true) {
    i2c_devices::BusSpec spec;
    spec.boards = {{"rab", {}}};
    if (main_board) spec.boards.push_back({.name = "main_board", .main_board = true});
    spec.log = log;
    return i2c_devices::make_bus_node(spec);
}

}  // namespace puckloop::tests
