#pragma once
// The faults of a board and its chip, other than those of analog inputs: when they are due, what they do, and
// the evidence. A node runs its board to next(), then calls act(); it does the same at a stop address.
//
//   reset `cause`; hang `duration`; brown_out `duration`; flip `space` `symbol` `address` `bit`;
//   interrupt `vector`                    at instants, or with `pc` and `nth` where the program arrives
//   flash `image` `sha256`                at instants
//   clock `ppm` `drift`; sag `volts`; battery `profile`  during the window
//   phase_open `motor` `winding`; wheel_stall `motor`; foreign_carrier `receiver`
//   ambient_burst `sensor` `strength`
//   emitter_dead `emitter`, receiver_dead `receiver`     burst by burst
//   lost_interrupt `vector`; late_interrupt `vector` `delay` `jitter`    interrupt by interrupt

#include "cosim/faults/spec/profile.h"
#include "emu/chip/faults/ambient_shares.h"
#include "emu/chip/faults/carried.h"
#include "emu/chip/faults/chip_access.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::chip {

/// What a fault can do to the board around the chip. A board without the part leaves the call out: the kinds
/// are refused for it where scenarios are read.
class BoardAccess {
  public:
    virtual ~BoardAccess() = default;
    /// False: there is no supply, and nothing can happen.
    virtual bool powered() const { return true; }
    /// The battery's voltage is lower by so much.
    virtual void set_sag(double /*volts*/) {}
    /// The battery has this voltage, before any sag, whatever the world sends; nullopt: what the world sends.
    virtual void set_battery(std::optional<double> /*volts*/) {}
    /// A burst of ambient light on each proximity sensor, or light barrier, 0 to 1.
    virtual void set_ambient(const AmbientShares& /*shares*/) {}
    /// Receivers that see another's carrier all the time: bit 0 is receiver 1.
    virtual void set_carrier(std::uint16_t /*receivers*/) {}
    /// `open`: bit 0 winding 1, bit 1 winding 2; motor 0 left, 1 right.
    virtual void set_motor(int /*motor*/, std::uint8_t /*open*/, bool /*stalled*/) {}
};

/// Address of a function or a variable by name.
struct Symbols {
    std::function<std::optional<std::uint32_t>(const std::string&)> code, data;
};

class BoardFaults {
  public:
    /// `chip` and `board` stay. The chip's time begins at `origin`; `ppm` is its own error. Throws
    /// InputError: an unknown symbol, register or vector, a bit or cell that does not exist.
    BoardFaults(std::vector<cosim::CarriedFault> faults, ChipAccess& chip, BoardAccess& board,
                const Symbols& symbols, double ppm, cosim::Time origin = 0);

    /// When something is due by time next; kNever: nothing is.
    cosim::Time next() const { return next_; }
    bool due(cosim::Time until, bool inclusive) const { return inclusive ? next_ <= until : next_ < until; }
    /// No fault acts before this: granted if one waits for the program.
    cosim::Time earliest(cosim::Time granted) const { return stops_.empty() ? next_ : granted; }
    /// A fault may have changed the clock's rate by then.
    bool clock_changed(cosim::Time time) const { return time >= clock_from_; }

    /// Does what is due at `now`, to which the chip has been run.
    void act(cosim::Time now);
    /// The chip stopped at an address before `now`.
    void arrived(cosim::Time now);
    /// A step of a motor that a fault kept the wheel from making.
    void lost_step(int motor, cosim::Time now);
    /// A burst of emitter or receiver `number`, from 1, begins at `now`: true if a fault takes it away.
    bool loses_burst(bool emitter, int number, cosim::Time now);
    /// A saved state of time `now` was loaded; `others`: of a run with faults, whose effects on the board
    /// end. All of that is due at `now`, and done by act(): while it is loaded a board can send nothing.
    void loaded(cosim::Time now, bool others);

    const std::vector<cosim::CarriedFault>& faults() const { return faults_; }

    template <class Archive>
    void state(Archive& archive) {
        list_faults(archive, faults_);
        if constexpr (Archive::kRaw) {
            archive(plans_, next_, stops_, holds_anew_);
        } else {
            std::map<std::string, std::uint64_t> arrivals;
            for (std::size_t i = 0; i < plans_.size(); ++i)
                arrivals[faults_[i].spec.name] = plans_[i].arrivals;
            archive(arrivals);
            for (std::size_t i = 0; i < plans_.size(); ++i)
                plans_[i].arrivals = arrivals[faults_[i].spec.name];
        }
    }

  private:
    enum class Kind : std::uint8_t {
        Reset,
        Hang,
        BrownOut,
        Flip,
        Interrupt,
        Flash,
        Clock,
        Sag,
        Battery,
        AmbientBurst,
        PhaseOpen,
        WheelStall,
        ForeignCarrier,
        EmitterDead,
        ReceiverDead,
        LostInterrupt,
        LateInterrupt
    };
    void name_places() const;
    static std::optional<Kind> kind_of(std::string_view name);
    struct Plan {
        Kind kind = Kind::Reset;
        bool holds = false;       ///< acts during the window, not at instants
        bool candidates = false;  ///< acts on bursts or interrupts, which come to it
        bool by_pc = false;
        std::uint32_t pc = 0;
        std::uint64_t arrivals = 0;  ///< at `pc`; or interrupts of the source so far
        cosim::Time burst = -1;      ///< the newest that was looked at: its parts share one fate
        bool burst_lost = false;
        cosim::Time due = cosim::kNever;
        FaultReset cause = FaultReset::External;
        int vector = 0;
        std::optional<MemoryPlace> place{};
        MemorySpace space = MemorySpace::Ram;
        int bit = -1;  ///< -1: drawn
    };
    Plan plan_of(const cosim::CarriedFault& fault, const Symbols& symbols) const;
    void plan_flip(Plan& plan, const cosim::CarriedFault& fault, const Symbols& symbols) const;
    void plan_next(std::size_t i, cosim::Time from);
    void settle_next();
    void watch();
    bool spent_at_pc(std::size_t i) const;
    bool live(cosim::Time now) const { return now >= origin_ && board_.powered(); }
    void fire(std::size_t i, cosim::Time now);
    std::string flip(std::size_t i);
    void hold(cosim::Time now);
    void show_profile(std::size_t i, cosim::Time now);
    cosim::Time next_step(std::size_t i, cosim::Time from) const;
    void watch_interrupts();
    cosim::Time interrupt_time(int vector, cosim::Time now);

    std::vector<cosim::CarriedFault> faults_;
    ChipAccess& chip_;
    BoardAccess& board_;
    double ppm_;
    cosim::Time origin_;
    std::vector<Plan> plans_;
    std::vector<std::vector<cosim::ProfilePoint>> profiles_;  ///< of `battery`; empty for the others
    std::vector<std::uint32_t> stops_;
    cosim::Time next_ = cosim::kNever;
    cosim::Time clock_from_ = cosim::kNever;  ///< the first begin of those that change the clock
    cosim::Time holds_anew_ = cosim::kNever;  ///< what holds is set once more then
    bool sags_ = false, drains_ = false, harms_motors_ = false, shines_ = false, dazzles_ = false;
};

}  // namespace puckloop::chip
