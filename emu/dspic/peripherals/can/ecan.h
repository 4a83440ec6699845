#pragma once
// ECAN1 and ECAN2 of the 33FJ: up to 32 message buffers in DMA RAM, eight of which can send, 16 filters,
// three masks and a FIFO, on top of what all CAN modules have in common (can_line.h, with its deviations).
// Sources: DS70185 (ECAN), DS70286 section 19.
//
// A buffer is eight words: SID, SRR, IDE; EID; EID, RTR, DLC; four of data; the filter that was hit. Two DMA
// channels in peripheral indirect mode carry them: CxRXD, CxTXD with the requests of CxRXIF, CxTXIF.
//
// Deviations
//  1. A buffer's words move at once, when its frame is offered to the bus or has been received.
//  2. DNCNT (filtering by data) is stored.
//  3. Filters, masks and pointers can be written in any mode; only the bit timing asks for Configuration
//  mode.
//  4. ICODE shows error, wake-up, overflow and FIFO before buffers.

#include "emu/dspic/peripherals/can/can_line.h"
#include "emu/dspic/peripherals/dma.h"

#include <array>
#include <cstdint>
#include <optional>

namespace puckloop::dspic {

class Ecan : public CanLine {
  public:
    struct Setup {
        int unit = 1;
        std::uint16_t base = 0;  ///< CxCTRL1; all others follow at fixed distances
        std::uint8_t irq = 0, receive_irq = 0, transmit_irq = 0;
        PortLetter port{};
        std::uint8_t rx = 0, tx = 0;
    };
    static constexpr int kWords = 64;  ///< from the first register to the last
    /// CxCTRL1.
    static constexpr std::uint16_t control(const Setup& setup) { return setup.base; }
    Ecan(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock, Ports& ports,
         Pins& pins, Dma& dma);

    void reset();

    template <class Archive>
    void state(Archive& archive) {
        CanLine::state(archive);
        archive(buffers_);
    }

  private:
    static constexpr int kBuffers = 32, kFilters = 16, kTransmitters = 8;
    static constexpr int kMessageWords = 8;
    using Message = std::array<std::uint16_t, kMessageWords>;
    /// The registers of window 0, and what the interrupt code shows.
    struct Buffers {
        std::array<std::uint16_t, 2> full{}, overflowed{};
        std::array<std::uint16_t, kTransmitters / 2> control{};
        std::uint8_t sent = 0, received = 0;  ///< last buffers

        template <class Archive>
        void state(Archive& archive) {
            archive(full, overflowed, control, sent, received);
        }
    };

    static std::uint16_t read_window(void* owner, std::uint16_t address);
    static void write_window(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_control(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_timing(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_interrupts(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_fifo(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_nothing(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);

    std::uint16_t& at(int offset) const { return reg(static_cast<std::uint16_t>(setup_.base + offset)); }
    std::uint16_t* of_buffers(int offset);
    void write_controls(int pair, std::uint16_t value, std::uint16_t mask);
    bool sends(int buffer) const;
    std::uint8_t control_of(int buffer) const override;
    void set_control(int buffer, std::uint8_t control) override;
    CanFrame frame_of(int buffer, Cycle now) override;
    void was_sent(int buffer, Cycle now) override;
    void show_code() override;

    // Reception (ecan_receive.cpp).
    void deliver(const CanFrame& frame, Cycle now) override;
    bool passes(int filter, const CanFrame& frame) const;
    bool full(int buffer) const {
        return buffers_.full[static_cast<std::size_t>(buffer / 16)] >> buffer % 16 & 1;
    }
    void store(int buffer, const CanFrame& frame, int filter, Cycle now);
    void store_in_fifo(const CanFrame& frame, int filter, Cycle now);
    void given_back();
    int fifo_end() const;
    int after(int buffer) const;

    Setup setup_;
    Dma& dma_;
    Buffers buffers_;
};

}  // namespace puckloop::dspic
