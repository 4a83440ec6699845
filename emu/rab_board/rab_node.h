#pragma once
// The range-and-bearing board as a node of a run: chip, board, and the ports where links attach.

#include "cosim/core/stateful_node.h"
#include "emu/board/node_state.h"
#include "emu/board/nvm_file.h"
#include "emu/chip/faults/board_faults.h"
#include "emu/dspic/chip/chip.h"
#include "emu/dspic/chip/chip_faults.h"
#include "emu/image/image.h"
#include "emu/rab_board/board.h"
#include "emu/rab_board/rab_log.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
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

class RabNode : public cosim::StatefulNode,
                public cosim::CountsWork,
                private BoardListener,
                private chip::BoardAccess {
  public:
    static constexpr cosim::PortIndex kUart1 = 0;
    static constexpr cosim::PortIndex kUart2 = 1;
    static constexpr cosim::PortIndex kI2c = 2;    ///< a device port of cosim/i2c/i2c_bus.h
    static constexpr cosim::PortIndex kIr = 3;     ///< signals: light
    static constexpr cosim::PortIndex kWorld = 4;  ///< signals: the robot's battery

    /// Throws InputError if the image does not fit the chip, or a fault neither.
    RabNode(const image::Image& image, const RabNodeOptions& options);

    std::string_view name() const override { return options_.board.name; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;
    std::optional<cosim::Time> begun(cosim::PortIndex port) const override;
    /// JSON: cycles, instructions, resets, traps, unmodelled registers, emission, I2C and UART counters.
    std::string finish() override;
    void add_work(cosim::WorkCounts& counts) const override;

    void state(StateWriter& archive) const override;
    void state(StateReader& archive) override;
    void state(CheckpointWriter& archive) const;
    void state(CheckpointReader& archive);
    cosim::Rewindable* rewindable() override { return &mark_; }
    void renew_random_streams() override { board_.renew_random_streams(); }

    dspic::Chip& chip() { return *chip_; }
    /// The end of the last advance.
    cosim::Time granted() const { return granted_; }
    /// A pulse on the reset pin where the chip is: between two advances, or before an instruction
    /// (chip::Instrument). What leaves at once goes to `outbox`.
    void press_reset(std::vector<cosim::Message>& outbox) {
        auto* const before = std::exchange(outbox_, &outbox);
        chip_->mclr();
        outbox_ = before;
    }
    Board& board() { return board_; }
    const RabLog& log() const { return log_; }

  private:
    void run_until(cosim::Time until);
    void run_faults(cosim::Time until, bool inclusive);
    void settle(cosim::Time until);
    void set_carrier(std::uint16_t receivers) override;
    void set_sag(double volts) override;
    void set_battery(std::optional<double> volts) override;
    /// The demodulator sees a carrier of the medium's, or one of a fault.
    void show_carrier(int receiver, cosim::Time now);
    void receive(const cosim::Message& message);
    void begin_i2c(cosim::I2cPhase phase, cosim::Time now);
    cosim::Time lookahead_when_idle() const;

    void signal_changed(SignalId id, double value, cosim::Time now) override;
    void emitters_changed(std::uint16_t on, cosim::Time now) override { log_.emitters(on, now); }
    void uart_sent(int unit, const cosim::UartFrame& frame) override;
    void i2c_answer(const cosim::I2cPhase& answer, cosim::Time now) override;
    void i2c_phase(int unit, const cosim::I2cPhase& phase) override;
    void can_to_bus(int unit, const cosim::CanMessage& message) override;

    RabNodeOptions options_;
    cosim::Time fastest_period_;
    std::vector<cosim::Port> ports_;
    board::CanPorts can_;
    Board board_;
    std::unique_ptr<dspic::Chip> chip_;
    RabLog log_;
    std::optional<dspic::ChipFaults> chip_faults_;
    std::unique_ptr<chip::BoardFaults>
        faults_;  ///< null: none was asked for, nor was there any in a loaded state
    board::NodeMark<RabNode, dspic::Chip, RabLog> mark_{*this, chip_, log_};
    std::vector<cosim::Message>* outbox_ = nullptr;
    cosim::Time granted_ = 0;
    struct Own {
        std::uint64_t master_phases = 0;
        // Only kept while there are faults; bit 0 is receiver 1.
        std::uint16_t seen = 0;     ///< receivers at which the medium has a carrier
        std::uint16_t foreign = 0;  ///< at which a fault has one

        template <class Archive>
        void state(Archive& archive) {
            archive(master_phases, seen, foreign);
        }
    } own_;
};

}  // namespace puckloop::rab
