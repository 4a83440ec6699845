#pragma once
// What runs a firmware's C sources on the host against an emulated chip: the sources' accesses to registers
// and volatile variables become accesses to the chip and let its time pass; the chip's own core, which
// executes a loop of one branch meanwhile, takes the interrupts, with their priorities and latency, and the
// sources' routines are called for them in between. So a routine can come between any two accesses, as on the
// robot.
//
// Deviations:
// 1. What lies between two accesses takes no time; an access takes `access_cycles`, which an input may
// choose.
// 2. A routine cannot come within an expression that has no volatile access.

#include <cstdint>

namespace hosted {

using Cycle = std::uint64_t;

/// The input is used up: thrown through the firmware's main().
struct InputEnds {};

class Host {
  public:
    Host();
    virtual ~Host();
    Host(const Host&) = delete;
    Host& operator=(const Host&) = delete;
    /// The one that there is.
    static Host& present();

    // From the firmware.
    void touch() { pass(access_cycles_); }
    void begin_instruction() {
        touch();
        ++whole_;
    }
    void end_instruction() { --whole_; }
    virtual std::uint16_t read_word(std::uint16_t address) = 0;
    virtual void write_word(std::uint16_t address, std::uint16_t value) = 0;
    virtual std::uint8_t read_byte(std::uint16_t address) = 0;
    virtual void write_byte(std::uint16_t address, std::uint8_t value) = 0;
    /// Until an interrupt.
    virtual void idle() = 0;

    virtual Cycle cycle() const = 0;
    void set_access_cycles(Cycle cycles) { access_cycles_ = cycles; }

  protected:
    /// Lets so many cycles pass, unless an instruction is under way.
    void pass(Cycle cycles);
    /// Runs the chip up to cycle `end`, or the next interrupt, whose routine is run.
    virtual void run_to(Cycle end) = 0;
    /// Hands in what is due now from outside. Returns the cycle of the next such, above the present one;
    /// throws InputEnds.
    virtual Cycle act() = 0;
    Cycle due() const { return due_; }
    /// act(), if it is time.
    void act_if_due();
    /// Runs a routine within a nesting of at most 16.
    void call(void (*routine)());

  private:
    static Host* present_;
    Cycle access_cycles_ = 4;
    Cycle due_ = 0;
    int whole_ = 0, depth_ = 0;
    bool acting_ = false;
};

/// Runs `firmware_main` on a host until its input ends. The firmware's variables must be as at a start.
void run_firmware(int (*firmware_main)());

}  // namespace hosted
