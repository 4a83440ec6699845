#pragma once
// The 33FJ's DMA controller: eight channels between the dual-port RAM and a peripheral's register, one word
// or byte a request. Requests are the interrupt sources' own numbers. Source: DS70286; fact sheet
// peripherals.md section 12.
//
// Deviations
//  1. A transfer takes place two cycles after its request; the bus is never busy, collisions (DMACS0,
//  DMACERR)
//     never happen.
//  2. Peripheral indirect addressing (AMODE 1x) works as register indirect with post-increment but for ECAN,
//     whose buffers move at once, all words of them.
//  3. Addresses beyond the 2 KB of DMA RAM wrap.

#include "emu/dspic/peripherals/surroundings.h"

#include <array>
#include <cstdint>
#include <span>

namespace puckloop::dspic {

class Dma {
  public:
    static constexpr int kChannels = 8;
    struct Setup {
        std::uint16_t con = 0;                       ///< DMA0CON; six words a channel follow
        std::uint16_t cs0 = 0;                       ///< DMACS0; DMACS1 and DSADR follow
        std::array<std::uint8_t, kChannels> irqs{};  ///< of the channels; 0: there is no controller
        std::uint16_t ram = 0;                       ///< data address of the DMA RAM
    };
    /// `ram`: the words of the DMA RAM.
    Dma(const Surroundings& around, const Setup& setup, std::span<std::uint16_t> ram);

    void reset();

    /// The register at `pad` moves whole buffers: its channels wait for block().
    void serve_blocks(std::uint16_t pad) { blocks_[block_count_++ % blocks_.size()] = pad; }
    /// The channel of source `irq` and register `pad`, if one is enabled, moves `words` at `offset` bytes
    /// from its start address, which the peripheral gives (peripheral indirect addressing).
    void block(int irq, std::uint16_t pad, unsigned offset, std::span<std::uint16_t> words, Cycle at);

    /// After the registers.
    template <class Archive>
    void state(Archive& archive) {
        archive(channels_, pending_);
        if constexpr (Archive::kLoads) listen();
    }

  private:
    struct Channel {
        bool second = false;       ///< ping-pong: STB in use
        std::uint16_t done = 0;    ///< transfers of the block
        std::uint16_t offset = 0;  ///< bytes from STA or STB

        template <class Archive>
        void state(Archive& archive) {
            archive(second, done, offset);
        }
    };

    static void write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_req(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_nothing(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void requested(void* owner, int irq, Cycle at);
    static void due(void* owner, Cycle due);

    void listen();
    void transfer(int number, Cycle at);
    void move(int number);
    void block_done(int number, Cycle at);
    std::uint16_t& reg(int number, int offset) const;

    Surroundings around_;
    Setup setup_;
    std::span<std::uint16_t> ram_;
    std::array<Channel, kChannels> channels_{};
    std::uint8_t pending_ = 0;  ///< channels with a request
    std::array<std::uint16_t, 4> blocks_{};
    std::size_t block_count_ = 0;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
