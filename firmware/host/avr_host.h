#pragma once
// An AVR chip, on the TAM's board, beside firmware that runs on the host.

#include "emu/tam_avr/board.h"
#include "firmware/host/host.h"
#include "firmware/host/vector.h"

#include <span>
#include <vector>

namespace hosted {

class AvrHost : public Host {
  public:
    AvrHost(puckloop::tam::Board& board, std::span<const Vector> vectors);

    std::uint16_t read_word(std::uint16_t address) override;
    void write_word(std::uint16_t address, std::uint16_t value) override;
    std::uint8_t read_byte(std::uint16_t address) override;
    void write_byte(std::uint16_t address, std::uint8_t value) override;
    void idle() override;
    void feed_watchdog();
    Cycle cycle() const override { return board_.chip().cycle(); }
    puckloop::cosim::Time time() const { return board_.chip().clock().time_of(cycle()); }

  protected:
    void run_to(Cycle end) override;
    Cycle cycles(double microseconds) const;
    puckloop::tam::Board& board() { return board_; }

  private:
    void serve(std::uint32_t stop);
    void set_pc(std::uint16_t word);
    void run_one(std::uint16_t word);

    puckloop::tam::Board& board_;
    std::vector<void (*)()> routines_;
};

}  // namespace hosted
