#pragma once
// I/O ports: TRISx, PORTx, LATx, analog pins, pins that other modules take over; input change notification
// (CN); and watched pins for the modules that count or trigger on edges. Source: dsPIC30F Family Reference
// Manual, section 11, and DS70286; fact sheet peripherals.md section 9.
//
// Deviations
//  1. A PORTx read in the instruction right after a write sees the new level; silicon wants one instruction
//     between.
//  2. Pins change one cycle after the start of the writing instruction, all at once, without slew or
//     contention.
//  3. A pin taken over by a UART or I2C module rests at its idle level; frames travel as messages, not as
//  levels.
//  4. CN pull-ups are stored; what an open pin reads is the board's affair.

#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/surroundings.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace puckloop::dspic {

class Ports {
  public:
    /// One port's registers; `odc` 0: no open-drain control.
    struct Place {
        PortLetter letter{};
        std::uint16_t tris = 0;
        std::uint16_t port = 0;
        std::uint16_t lat = 0;
        std::uint16_t odc = 0;
    };
    struct Pin {
        PortLetter port{};
        std::uint8_t number = 0;
    };
    struct Setup {
        std::span<const Place> ports;
        std::span<const Pin> analog;  ///< AN0, AN1, ...
        /// PCFG bits of AN0..15 and AN16..31, 1 = digital; a pin is analog if any register has it so. 0:
        /// none.
        std::array<std::uint16_t, 2> pcfg_low{};
        std::uint16_t pcfg_high = 0;
        std::array<std::uint16_t, 2> cnen{};
        std::array<std::uint16_t, 2> cnpu{};
        std::uint8_t change_irq = 0;
    };
    Ports(const Surroundings& around, const Setup& setup, Pins& pins);

    void reset();
    /// The outside changed levels on `port` at cycle `at`.
    void outside_changed(PortLetter port, Cycle at);
    /// Takes pins away from LAT and TRIS: `output` of them are driven at `levels`, the rest are released.
    void take_over(PortLetter port, std::uint16_t mask, std::uint16_t output, std::uint16_t levels) {
        take_over(port, mask, output, levels, around_.now + 1);
    }
    /// The same, from an event that was due at cycle `when`.
    void take_over(PortLetter port, std::uint16_t mask, std::uint16_t output, std::uint16_t levels,
                   Cycle when);
    void release(PortLetter port, std::uint16_t mask);
    /// Pins that are taken over at present.
    std::uint16_t taken_over(PortLetter port) const { return at(port).taken_over; }
    /// Calls `changed` with the pin's level at every edge, driven by whomever; at a reset, and where
    /// `monitors` becomes true, with `at` = kNoCycle: there the level is just given. `monitors`: whether
    /// edges make a difference just now, to be followed by monitoring_changed() when that changes; without it
    /// they always do.
    void watch(PortLetter port, int pin, void* owner, void (*changed)(void* owner, bool level, Cycle at),
               bool (*monitors)(const void* owner) = nullptr);
    void monitoring_changed();
    /// The next cycle after `after` at which the board itself may change a pin whose edges are monitored.
    Cycle next_edge(Cycle after) const;
    /// Edges of one of its pins are, or were, looked for.
    bool monitors(PortLetter port) const { return at(port).watched != 0; }
    /// The board may have changed such pins at cycle `at`.
    void sample_monitored(Cycle at);
    /// Called when monitoring_changed() found other pins than before; may stay empty.
    void (*on_monitoring)(void* owner, Cycle at) = nullptr;
    void* on_monitoring_owner = nullptr;
    /// As watch(), but edges are called out only after attend(); those of CN and other modules' pins may be,
    /// too.
    void listen(PortLetter port, int pin, void* owner, void (*changed)(void* owner, bool level, Cycle at));
    /// From now on edges of this pin are looked for.
    void attend(PortLetter port, int pin);
    /// Called before each write that can change what the pins do, with the last cycle before the change;
    /// may stay empty.
    void (*before_change)(void* owner, Cycle until) = nullptr;
    void* before_change_owner = nullptr;
    /// Level on the pin now, as its input buffer sees it.
    bool level(PortLetter port, int pin) const;
    /// What the chip's own driver puts on analog input AN`channel`'s pin, if it drives it.
    std::optional<bool> driven_level(int channel) const;
    /// The pin of AN`channel` is a digital one: cut off from the converters.
    bool digital(int channel) const;
    /// What a module's digital input on the pin sees: 0 while the pin is an analog one.
    bool digital_level(PortLetter port, int pin) const;
    /// Pins of the port that are inputs and whose level something outside may change.
    std::uint16_t changeable(PortLetter port) const;
    /// Puts the pin levels into PORTx's storage.
    void refresh();

    template <class Archive>
    void state(Archive& archive) {
        archive(ports_);
    }

    static constexpr int kPorts = 7;

  private:
    struct Port {
        std::uint16_t tris = 0;  ///< register addresses; 0: the device has no such port
        std::uint16_t port = 0;
        std::uint16_t lat = 0;
        std::uint16_t odc = 0;
        std::uint16_t implemented = 0;
        std::uint16_t analog = 0;  ///< pins that can be analog inputs
        std::uint16_t taken_over = 0;
        std::uint16_t taken_over_output = 0;
        std::uint16_t taken_over_levels = 0;
        std::uint16_t driven = 0;     ///< as last given to the board
        std::uint16_t levels = 0;     ///< as last given to the board
        std::uint16_t watched = 0;    ///< pins with a watcher or CN input
        std::uint16_t seen = 0;       ///< levels of the watched pins when last looked at
        std::uint16_t noticed = 0;    ///< pin levels at the last PORT read, what CN compares with
        std::uint16_t monitored = 0;  ///< watched pins whose edges make a difference

        template <class Archive>
        void state(Archive& archive) {
            archive(taken_over, taken_over_output, taken_over_levels, driven, levels, watched, seen, noticed,
                    monitored);
        }
    };
    struct Watcher {
        PortLetter port{};
        std::uint16_t mask = 0;
        void* owner = nullptr;
        void (*changed)(void*, bool, Cycle) = nullptr;
        bool (*monitors)(const void*) = nullptr;
    };

    static std::uint16_t look_at_port(void* owner, std::uint16_t address);
    static std::uint16_t read_port(void* owner, std::uint16_t address);
    static void write_port(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_tris(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_cn(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);

    Port& at(PortLetter letter) { return ports_[static_cast<std::size_t>(letter)]; }
    const Port& at(PortLetter letter) const { return ports_[static_cast<std::size_t>(letter)]; }
    int index_of(std::uint16_t address) const { return places_[address >> 1]; }
    std::uint16_t digital_pins(int index) const;
    std::uint32_t pcfg() const;
    std::uint16_t pin_levels(int index, Cycle now) const;
    std::uint16_t quiet_levels(int index) const;
    static std::uint16_t seen_by_buffers(const Port& port, std::uint16_t outside);
    void announce() const {
        if (before_change) before_change(before_change_owner, around_.now);
    }
    void drive(int index, Cycle when);
    void look(int index, Cycle when);
    std::uint16_t change_enabled(int index) const;

    Surroundings around_;
    Setup setup_;
    Pins& pins_;
    std::array<Port, kPorts> ports_{};
    std::array<std::uint8_t, SfrSpace::kWords> places_{};  ///< index of the port, by register word
    std::vector<Watcher> watchers_;
};

}  // namespace puckloop::dspic
