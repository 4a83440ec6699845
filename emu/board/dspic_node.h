#pragma once
// What nodes of boards with a dsPIC have in common: UARTs, CAN, I2C as a device, the log, faults, and what is
// saved.
//
// Beside what BoardNode asks for, a node has
//   own()    what it saves besides board, chip and log
//   mark_    a NodeMark
//   kI2cUnit the I2C module on the robot's bus

#include "emu/board/board_node.h"
#include "emu/board/can_ports.h"
#include "emu/board/node_state.h"
#include "emu/dspic/chip/chip.h"
#include "emu/dspic/chip/chip_faults.h"
#include "emu/image/image.h"
#include "protocols/serial/uart_sampling.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::board {

template <class Self, class Board, class Log>
class DspicNode : public BoardNode<Self>, public cosim::CountsWork {
  public:
    static constexpr cosim::PortIndex kUart1 = 0, kUart2 = 1, kI2c = 2;

    std::optional<cosim::Time> begun(cosim::PortIndex port) const override {
        if (port != kUart1 && port != kUart2) return std::nullopt;
        return chip_->uart_begun(uart_unit(port));
    }
    void add_work(cosim::WorkCounts& counts) const override {
        chip_->add_work(counts);
        counts.emplace_back("bytes copied for going back", self().mark_.bytes());
    }

    void state(StateWriter& archive) const override {
        save_node(archive, this->granted_, self().own(), board_, *chip_, log_);
        save_faults(archive, this->faults_.get());
    }
    void state(StateReader& archive) override {
        load_node(archive, this->granted_, self().own(), board_, *chip_, log_);
        this->find_next_reset();
        load_faults(archive, this->faults_, this->granted_, [this] {
            chip_faults_.emplace(*chip_);
            return std::make_unique<chip::BoardFaults>(std::vector<cosim::CarriedFault>{}, *chip_faults_,
                                                       static_cast<chip::BoardAccess&>(*this),
                                                       chip::Symbols{}, crystal_ppm_);
        });
    }
    void state(CheckpointWriter& archive) const { list_checkpoint(archive, *this); }
    void state(CheckpointReader& archive) { list_checkpoint(archive, *this); }
    void renew_random_streams() override { board_.renew_random_streams(); }

    dspic::Chip& chip() { return *chip_; }
    Board& board() { return board_; }
    const Log& log() const { return log_; }
    /// A pulse on the reset pin where the chip is: between two advances, or before an instruction
    /// (chip::Instrument). What leaves at once goes to `outbox`.
    void press_reset(std::vector<cosim::Message>& outbox) {
        this->collect(outbox, [this](bool) { chip_->mclr(); });
    }

  protected:
    friend BoardNode<Self>;

    template <class Parameters, class Listener>
    DspicNode(const Parameters& parameters, Listener& listener, std::vector<cosim::Port> ports,
              std::vector<cosim::Time> resets, const std::string& log, const image::Image& image)
        : BoardNode<Self>(parameters.name, std::move(ports), std::move(resets)),
          board_(parameters, listener),
          log_(log, image),
          crystal_ppm_(parameters.crystal_ppm) {}

    /// Loads the image, and switches the chip on. Throws InputError if the image does not fit the chip, or a
    /// fault neither.
    void switch_on(const image::Image& image, bool skip_idle,
                   const std::vector<cosim::CarriedFault>& faults) {
        chip_->set_skipping(skip_idle);
        chip_->load(image);
        chip_->power_on();
        if (faults.empty()) return;
        chip_faults_.emplace(*chip_);
        this->faults_ = make_faults(faults,
                                    {*chip_faults_, static_cast<chip::BoardAccess&>(*this),
                                     board_.analog_faults(), chip_->clock(), crystal_ppm_},
                                    symbols_of(image));
    }

    static int uart_unit(cosim::PortIndex port) { return port == kUart1 ? 1 : 2; }
    /// `time`, or where the chip is, if its clock's rate has changed meanwhile.
    cosim::Time reached(cosim::Time time) const { return board::reached(*chip_, this->faults_.get(), time); }

    void look() { log_.look(*chip_); }
    void run_board(cosim::Time until) { run_past_faults(*chip_, this->faults_.get(), until); }
    void push_reset_button() { chip_->mclr(); }

    void receive_uart(const cosim::Message& message, const cosim::UartFrame& frame) {
        const int unit = uart_unit(message.port);
        log_.arrived(unit, frame, message.time, chip_->uart_enabled(unit));
        chip_->uart_receive(unit, frame);
    }
    void send_uart(int unit, const cosim::UartFrame& frame) {
        const cosim::Time stop_bit = protocols::stop_bit_start(frame);
        log_.sent(unit, frame, stop_bit);
        this->outbox_->push_back({reached(stop_bit), unit == 1 ? kUart1 : kUart2, frame});
    }
    void receive_can(const cosim::Message& message, const cosim::CanMessage& frame) {
        chip_->can_news(can_.unit_of(message.port), frame);
    }
    void send_can(int unit, const cosim::CanMessage& message) {
        this->outbox_->push_back({reached(message.start), can_.port_of(unit), message});
    }

    /// When the chip as a device of the robot's bus answers next; kNever: nobody waits for an answer.
    cosim::Time earliest_answer() const {
        const cosim::Time earliest = chip_->earliest_i2c_slave_answer(Self::kI2cUnit);
        return std::max(this->granted_, this->faults_ && earliest != cosim::kNever
                                            ? std::min(earliest, this->faults_->earliest(this->granted_))
                                            : earliest);
    }
    bool answers() const { return chip_->earliest_i2c_slave_answer(Self::kI2cUnit) != cosim::kNever; }

    CanPorts can_;
    Board board_;
    std::unique_ptr<dspic::Chip> chip_;
    Log log_;

  private:
    Self& self() { return static_cast<Self&>(*this); }
    const Self& self() const { return static_cast<const Self&>(*this); }

    template <class Archive, class Whole>
    static void list_checkpoint(Archive& archive, Whole& whole) {
        BoardNode<Self>::list_node(archive, whole);
        archive(whole.self().own(), whole.board_, *whole.chip_, whole.log_);
        if (whole.faults_) archive(*whole.faults_);
    }

    double crystal_ppm_;
    std::optional<dspic::ChipFaults> chip_faults_;
};

}  // namespace puckloop::board
