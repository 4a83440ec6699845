#pragma once
// The master of a dsPIC's I2C module on the wires, one activity after the other. Source: dsPIC30F Family
// Reference Manual (DS70068), sections 21.5 and 21.6: each activity, its bits of I2CCON and I2CSTAT, when
// they end, collisions.

#include <cstdint>

namespace puckloop::wires {

class WireMaster {
  public:
    enum class Activity { Idle, Start, Restart, Stop, Receive, Acknowledge, Transmit };

    /// SEN, RSEN, PEN, RCEN or ACKEN is set. One that comes while another is active does nothing.
    /// A START finds SDA or SCL low while another master has the bus: a collision.
    void begin(Activity activity) {
        if (activity_ != Activity::Idle) return;
        if (activity == Activity::Start && taken_) {
            lost_ = true;
            ++interrupts_;
            return;
        }
        activity_ = activity;
    }
    /// START and STOP conditions of others are detected at all times.
    void other_starts() {
        taken_ = s_ = true;
        p_ = false;
    }
    void other_stops() {
        p_ = true;
        taken_ = s_ = false;
    }
    void write_transmit(std::uint8_t byte) {
        if (activity_ != Activity::Idle) {
            collides_ = true;
            return;
        }
        activity_ = Activity::Transmit;
        trn_ = byte;
        full_ = transmits_ = true;
    }
    std::uint8_t read_receive() {
        received_full_ = false;
        return rcv_;
    }
    void clear_sticky() { collides_ = overflow_ = lost_ = false; }

    /// The activity goes through its clocks; `others` is what slaves and other masters leave of SDA in the
    /// first eight (a STOP or repeated START meets the first of them), `low` whether one pulls it low in the
    /// ninth. `refuses`: ACKDT.
    void finish(std::uint8_t others, bool low, bool refuses) {
        const Activity done = activity_;
        activity_ = Activity::Idle;
        ++interrupts_;
        switch (done) {
        case Activity::Start:
        case Activity::Restart:
            if (mine_ && others < 0x80) {  // SDA is low: no START can be made
                lost_ = true;
                mine_ = false;
                break;
            }
            s_ = mine_ = true;
            p_ = false;
            break;
        case Activity::Stop:
            mine_ = false;
            if (others < 0x80) {  // SDA does not rise
                lost_ = true;
                break;
            }
            p_ = true;
            s_ = false;
            break;
        case Activity::Receive: {
            std::uint8_t shifted = 0;
            for (int bit = 7; bit >= 0; --bit)
                shifted = static_cast<std::uint8_t>(shifted << 1 | (others >> bit & 1));
            if (received_full_) {
                overflow_ = true;
            } else {
                rcv_ = shifted;
                received_full_ = true;
            }
            break;
        }
        case Activity::Transmit:
            for (int bit = 7; bit >= 0; --bit) {
                if (!(trn_ >> bit & 1) || (others >> bit & 1)) continue;
                lost_ = true;  // it lets SDA go and finds it low
                mine_ = transmits_ = full_ = false;
                return;
            }
            full_ = transmits_ = false;
            refused_ = !low;
            break;
        case Activity::Acknowledge:
            if (!refuses || !low) break;
            lost_ = true;
            mine_ = false;
            break;
        case Activity::Idle:
            break;
        }
    }

    bool mine() const { return mine_; }
    bool taken() const { return taken_; }
    bool idle() const { return activity_ == Activity::Idle; }
    bool lost() const { return lost_; }
    int interrupts() const { return interrupts_; }
    /// ACKEN to SEN.
    std::uint16_t control() const {
        switch (activity_) {
        case Activity::Start:
            return 0x01;
        case Activity::Restart:
            return 0x02;
        case Activity::Stop:
            return 0x04;
        case Activity::Receive:
            return 0x08;
        case Activity::Acknowledge:
            return 0x10;
        case Activity::Idle:
        case Activity::Transmit:
            return 0;
        }
        return 0;
    }
    static constexpr std::uint16_t kCompared = 0xC4DB;  ///< all that the master owns
    std::uint16_t status() const {
        unsigned bits = 0;
        const auto set = [&bits](int bit, bool value) { bits |= value ? 1u << bit : 0u; };
        set(15, refused_);
        set(14, transmits_);
        set(10, lost_);
        set(7, collides_);
        set(6, overflow_);
        set(4, p_);
        set(3, s_);
        set(1, received_full_);
        set(0, full_);
        return static_cast<std::uint16_t>(bits);
    }

  private:
    Activity activity_ = Activity::Idle;
    std::uint8_t trn_ = 0, rcv_ = 0;
    int interrupts_ = 0;
    bool mine_ = false, s_ = false, p_ = false, full_ = false, transmits_ = false, refused_ = false,
         received_full_ = false, overflow_ = false, collides_ = false, lost_ = false, taken_ = false;
};

}  // namespace puckloop::wires
