#pragma once
// Input capture modules IC1 to IC8: the count of Timer2 or Timer3 at edges of a pin, in a buffer of four.
// Source: dsPIC30F Family Reference Manual, section 13 (DS70060), and DS70198 of the 33F; fact sheet
// peripherals.md section 6.
//
// Deviations
//  1. The count is taken, and ICxIF set, one cycle after the first cycle that starts at or after the edge
//     (the manual: 1 to 2 counts after the edge, depending on its place in the cycle).
//  2. An interrupt due while ICOV is set comes only with ICI = 0 or ICM = 1, as the manual has it; captures
//     are lost until the four words have been read.
//  3. A UART's line (UxMODE<ABAUD>) reaches its module one frame late, with exact intervals: a frame is known
//     when its stop bit begins.
//  4. Reading an empty buffer yields the last word read.

#include "cosim/core/clock.h"
#include "cosim/core/message.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/surroundings.h"
#include "emu/dspic/peripherals/timing/timer.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace puckloop::dspic {

class InputCapture {
  public:
    struct Unit {
        std::uint16_t buf = 0;  ///< ICxBUF; ICxCON follows
        std::uint8_t irq = 0;
        Ports::Pin pin;
    };
    /// `units`: IC1 on. `timers`: Timer2 and Timer3.
    InputCapture(const Surroundings& around, std::span<const Unit> units, std::array<Timer*, 2> timers,
                 const cosim::ClockDomain& clock, Ports& ports);

    void reset();
    /// Sleep, or Idle for modules with ICSIDL set: only ICM = 7 sees edges, in Sleep and Idle alone.
    void hold(bool sleeps, bool idles) {
        if (used_) set_hold(sleeps, idles);
    }
    /// IC`unit` sees a UART's line instead of its pin from now on, or its pin again.
    void take_line(int unit, bool on);
    /// A frame on that line whose stop bit begins at cycle `at`.
    void line_frame(int unit, const cosim::UartFrame& frame, Cycle at);

    template <class Archive>
    void state(Archive& archive) {
        archive(used_);
        if constexpr (Archive::kLoads)
            if (!used_) clear();
        if (!used_) return;
        archive(dozes_);
        archive.fixed(states_);
        archive(pending_);
        for (const Pending& pending : pending_)
            archive.check(pending.unit < units_.size(), "an edge at no capture module");
    }

  private:
    static constexpr std::size_t kDepth = 4;
    struct State {
        std::array<std::uint16_t, kDepth> words{};
        std::uint8_t first = 0;
        std::uint8_t count = 0;
        std::uint8_t edges = 0;     ///< rising edges since the prescaler last came to its end
        std::uint8_t captures = 0;  ///< since the last interrupt
        bool held = false;
        bool line = false;  ///< a UART's line stands in for the pin
        std::uint16_t last = 0;

        template <class Archive>
        void state(Archive& archive) {
            archive(words);
            archive.bounded(first, 0, kDepth - 1);
            archive.bounded(count, 0, kDepth);
            archive(edges, captures, held, line, last);
        }
    };
    /// What is still to come, by cycle.
    struct Pending {
        Cycle at = 0;
        std::uint8_t unit = 0;  ///< index
        bool edge = false;      ///< an edge of a UART's line, to `level`; else a capture
        bool level = false;

        template <class Archive>
        void state(Archive& archive) {
            archive(at, unit, edge, level);
        }
    };
    struct Input {
        InputCapture* self = nullptr;
        std::uint8_t unit = 0;
    };

    static std::uint16_t read_buf(void* owner, std::uint16_t address);
    static std::uint16_t look_at_buf(void* owner, std::uint16_t address);
    static void write_buf(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void pin_changed(void* owner, bool level, Cycle at);
    static void due(void* owner, Cycle due);

    std::size_t index_of(std::uint16_t address) const { return (address - units_.front().buf) / 4u; }
    std::uint16_t& con(std::size_t index) const {
        return around_.sfr.raw(static_cast<std::uint16_t>(units_[index].buf + 2));
    }
    unsigned mode(std::size_t index) const;
    void clear();
    void set_hold(bool sleeps, bool idles);
    void edge(std::size_t index, bool level, Cycle at);
    void capture(std::size_t index, Cycle at);
    void add(const Pending& pending);
    void plan();
    void show(std::size_t index);

    Surroundings around_;
    std::span<const Unit> units_;
    std::array<Timer*, 2> timers_;
    const cosim::ClockDomain& clock_;
    Ports& ports_;
    std::vector<Input> inputs_;
    bool used_ = false;   ///< a module was ever switched on, or given a line: there is something to remember
    bool dozes_ = false;  ///< the CPU is in Sleep or Idle
    std::vector<State> states_;
    std::vector<Pending> pending_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
