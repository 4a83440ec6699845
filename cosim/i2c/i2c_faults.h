#pragma once
// The faults of one I2C bus: watches every byte that a master sends or clocks, decides which of them suffer
// and what of, and keeps evidence of it.

#include "cosim/core/message.h"
#include "cosim/faults/fault_json.h"
#include "cosim/i2c/i2c_fault.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::cosim {

/// What becomes of one byte.
struct I2cDamage {
    I2cPhase phase;              ///< as the devices see it
    bool refused = false;        ///< no device takes it
    bool restarted = false;      ///< devices see a START before it
    bool stopped = false;        ///< devices see a STOP before it
    bool reset = false;          ///< the addressed devices begin anew before it
    bool lost = false;           ///< its master lost the bus
    Time busy_until = 0;         ///< lost: somebody else has the bus until then
    Time hold = 0;               ///< SCL stays low for so much longer
    bool acknowledged = false;   ///< SDA is low in the ninth clock, whatever the devices do
    std::uint8_t low = 0;        ///< bits of a byte read during which SDA is low
    std::uint8_t flipped = 0;    ///< bits of a byte read that are inverted on the way
    bool second_device = false;  ///< another device answers with `value`
    std::uint8_t value = 0xFF;
};

/// A transfer that somebody begins and does not end.
struct I2cIncomplete {
    std::uint8_t address_byte = 0;
    bool with_byte = false;  ///< 0x00 follows
};

class I2cFaults {
  public:
    /// `masters`: port names by index; `nominal`: the bus's shortest clock period. Throws InputError.
    I2cFaults(std::vector<CarriedFault> faults, std::vector<std::string> masters, Time nominal);

    bool empty() const { return faults_.empty(); }
    /// `master`, who owns the bus, begins this Start, Write or Read.
    I2cDamage strike(PortIndex master, const I2cPhase& phase);
    /// When both lines are high, if a master looks at `now` and nobody else drives them: `now` or later.
    Time free_from(PortIndex master, Time now);
    /// When the next incomplete transfer falls due; it is begun once the bus is free.
    Time next_incomplete() const;
    std::optional<I2cIncomplete> take_incomplete(Time now);

    /// The run is over at `now`: what was low on a bus at rest counts too.
    void conclude(Time now) { note_quiet(now, true); }
    /// With what became of them.
    const std::vector<CarriedFault>& carried() const { return carried_; }

    template <class Archive>
    void state(Archive& archive) {
        archive.fixed(carried_);
        archive.fixed(faults_);
        archive(pointers_, deaf_, address_, reading_, position_, phases_);
    }

  private:
    /// Beside the CarriedFault with the same index.
    struct Fault {
        I2cFault what;
        PortIndex master = 0;                        ///< index of what.where.master
        Time low_from = kNever, low_until = kNever;  ///< Sda and Scl
        Time counted = kNever;                       ///< the window that has been counted as fired
        Time next = kNever;                          ///< the next incomplete transfer

        template <class Archive>
        void state(Archive& archive) {
            archive(low_from, low_until, counted, next);
        }
    };

    void track(const I2cPhase& phase);
    bool meant(const Fault& fault, PortIndex master, const I2cPhase& phase) const;
    void harm(std::size_t index, PortIndex master, const I2cPhase& phase, I2cDamage& damage);
    /// What a line that is low during [low_from, low_until) does to the byte; true if it does anything.
    bool pull(const Fault& fault, const I2cPhase& phase, I2cDamage& damage) const;
    void pulled(std::size_t index, PortIndex master, const I2cPhase& phase, const std::string& how = {});
    void note_quiet(Time now, bool over);
    int lose_at_bit(std::size_t index, const I2cPhase& phase, I2cDamage& damage);
    void note(std::size_t index, PortIndex master, const I2cPhase& phase, int bit = -1,
              const std::string& more = {});
    std::optional<std::uint8_t> current_register() const;
    std::string describe(PortIndex master, const I2cPhase& phase, int bit) const;

    std::vector<CarriedFault> carried_;
    std::vector<Fault> faults_;
    std::vector<std::string> masters_;
    Time nominal_;
    // Of the transfer under way, as its master means it.
    std::uint8_t address_ = 0;
    bool reading_ = false;
    std::uint32_t position_ = 0;
    std::uint64_t phases_ = 0;                       // begun so far
    std::map<std::uint8_t, std::uint8_t> pointers_;  // register pointers by address
    std::map<std::uint8_t, Time> deaf_;              // devices that are beginning anew, until when
};

}  // namespace puckloop::cosim
