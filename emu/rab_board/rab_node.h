#pragma once
// The range-and-bearing board as a node of a run: chip, board, and the ports where links attach.

#include "cosim/core/sampled_inputs.h"
#include "emu/board/dspic_node.h"
#include "emu/board/i2c_device.h"
#include "emu/board/nvm_file.h"
#include "emu/board/turn_hold.h"
#include "emu/dspic/chip/look_gate.h"
#include "emu/image/image.h"
#include "emu/rab_board/board.h"
#include "emu/rab_board/rab_log.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::rab {

struct RabNodeOptions {
    BoardParameters board;  ///< its name is the node's name
    bool skip_idle = true;  ///< busy-wait loops are skipped forward
    /// No master on the bus is faster; one that is gets its answers as if it were not. The slower this is,
    /// the further ahead the bus may run.
    double fastest_i2c_hertz = 400e3;
    std::string log{};                          ///< file for the board's log; empty: none
    std::shared_ptr<board::NvmFile> nvm{};      ///< keeps flash and EEPROM at the end; null: nothing does
    std::vector<cosim::CarriedFault> faults{};  ///< of this board
};

class RabNode : private BoardListener,
                public board::DspicNode<RabNode, Board, RabLog>,
                public cosim::SampledInputs {
    friend board::BoardNode<RabNode>;
    friend board::DspicNode<RabNode, Board, RabLog>;

  public:
    // kI2c is a device port of cosim/i2c/i2c_bus.h.
    static constexpr cosim::PortIndex kIr = 3;     ///< signals: light
    static constexpr cosim::PortIndex kWorld = 4;  ///< signals: the robot's battery

    /// Throws InputError if the image does not fit the chip, or a fault neither.
    RabNode(const image::Image& image, const RabNodeOptions& options);

    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;
    /// JSON: cycles, instructions, resets, traps, unmodelled registers, emission, I2C and UART counters.
    std::string finish() override;
    cosim::Rewindable* rewindable() override { return &mark_; }

    bool sampled(cosim::PortIndex port) const override { return port == kIr; }
    /// A device on the bus speaks when it is asked.
    bool independent(cosim::PortIndex port) const override { return port == kI2c; }
    std::optional<cosim::PortIndex> turn_port() const override { return kI2c; }
    bool has_turn() const override;
    cosim::Time advance_sampling(const cosim::SampledReach& reach, std::span<const cosim::Message> inbox,
                                 std::vector<cosim::Message>& outbox) override;

  private:
    static constexpr int kI2cUnit = rab::kI2cUnit;

    void settle(cosim::Time until);
    bool takes_ahead(const cosim::Message& message);
    void run_board(cosim::Time until) { DspicNode::run_board(std::min(until, turn_.limit())); }
    bool held_back() const { return gate_->held() || turn_.limit() <= chip_->now(); }
    bool looks_by_program() const;
    void receive(const cosim::Message& message);
    void receive_signal(const cosim::Signal& signal, cosim::Time now);
    void receive_i2c(const cosim::I2cPhase& phase, cosim::Time now);
    void set_carrier(std::uint16_t receivers) override;
    void set_sag(double volts) override;
    void set_battery(std::optional<double> volts) override;
    void note_carrier(int receiver, bool seen);
    /// The demodulator sees a carrier of the medium's, or one of a fault.
    void show_carrier(int receiver, cosim::Time now);

    void signal_changed(SignalId id, double value, cosim::Time now) override;
    void emitters_changed(std::uint16_t on, cosim::Time now) override { log_.emitters(on, now); }
    void uart_sent(int unit, const cosim::UartFrame& frame) override { send_uart(unit, frame); }
    void i2c_answer(const cosim::I2cPhase& answer, cosim::Time now) override;
    void i2c_phase(int unit, const cosim::I2cPhase& phase) override;
    void can_to_bus(int unit, const cosim::CanMessage& message) override { send_can(unit, message); }

    struct Own {
        std::uint64_t master_phases = 0;
        // Only kept while there are faults; bit 0 is receiver 1.
        std::uint16_t seen = 0;     ///< receivers at which the medium has a carrier
        std::uint16_t foreign = 0;  ///< at which a fault has one

        template <class Archive>
        void state(Archive& archive) {
            archive(master_phases, seen, foreign);
        }
    };
    Own& own() { return own_; }
    const Own& own() const { return own_; }

    RabNodeOptions options_;
    board::I2cDeviceTimes i2c_times_;
    Own own_;
    std::optional<dspic::LookGate> gate_;  ///< before looks at light; set once there is a chip
    board::TurnHold turn_;                 ///< as a device of the bus
    board::NodeMark<RabNode, dspic::Chip, RabLog> mark_{*this, chip_, log_};
};

}  // namespace puckloop::rab
