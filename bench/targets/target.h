#pragma once
// What lies on the bench: one chip or one board, whatever its kind.

#include "bench/bus/i2c_device_spec.h"
#include "cosim/core/clock.h"
#include "cosim/core/message.h"
#include "cosim/core/signal_info.h"
#include "cosim/core/time.h"
#include "emu/dspic/chip/chip.h"
#include "emu/image/image.h"
#include "emu/pic/board_revision.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop {
class StateReader;
class StateWriter;
}  // namespace puckloop
namespace puckloop::board {
class NvmFile;
}
namespace puckloop::image {
class LineTable;
}
namespace puckloop::debug {
class DebugChip;
}

namespace puckloop::exec {

/// The I2C module that an `--i2c` script speaks to.
inline constexpr int kI2cScriptUnit = 1;
/// The I2C module that devices of `--i2c-device` are connected to.
inline constexpr int kI2cDeviceUnit = 1;

/// What the target does that the bench records or passes on.
class TargetListener {
  public:
    virtual ~TargetListener() = default;
    virtual void uart_sent(int unit, const cosim::UartFrame& frame) = 0;
    /// A phase of which the target was the master is over: `ack`, `stretch` and the byte of a Read are what
    /// was on the wires. Of one that nobody answered (the chip was reset) they are what the master began
    /// with.
    virtual void i2c_phase(int unit, const cosim::I2cPhase& phase) = 0;
    /// The target, as slave of I2C module kI2cScriptUnit, answered the script's last phase.
    virtual void i2c_answered(const cosim::I2cPhase& answer, cosim::Time time) = 0;
    /// A pin took a driven level, or became an input (no level).
    virtual void pin_changed(std::string_view pin, std::string_view function, std::optional<bool> level,
                             cosim::Time time) = 0;
    /// An output signal that is no pin of its own (a wheel) changed.
    virtual void signal_changed(std::string_view name, double value, cosim::Time time) = 0;
    /// A codec turned a sample into sound, -1..1 of full scale.
    virtual void sound_sample(double /*value*/, cosim::Time /*time*/) {}
};

struct TargetOptions {
    dspic::ChipOptions chip;
    std::uint64_t seed = 1;
    double adc_noise_counts = 0.0;
    int selector = 0;
    pic::Revision revision = pic::Revision::Rev12;  ///< of the e-puck main board
    std::string camera = "po3030k";                 ///< of the e-puck main board, or "none"
    bool camera_turned = false;                     ///< it lies on its side, as on early boards
    std::string camera_picture{};              ///< PGM or PPM file that it looks at; empty: a test pattern
    std::string camera_log{};                  ///< file for a line per picture; empty: none
    bool skip_idle = true;                     ///< busy-wait loops are skipped forward
    std::string log{};                         ///< file for the board's log, where it keeps one; empty: none
    std::vector<I2cDeviceSpec> i2c_devices{};  ///< on the bus of a target that is a master
    std::vector<std::uint8_t> fuses{};  ///< of an AVR: low, high, extended, perhaps lock; empty: the image's
    std::string rab_log{};  ///< file for the log of a range-and-bearing board among them; empty: none
};

class Target {
  public:
    virtual ~Target() = default;

    virtual std::span<const cosim::SignalInfo> signals() const = 0;
    /// From now on; the value is clipped to the signal's range.
    virtual void set_signal(std::uint16_t id, double value) = 0;
    virtual double signal(std::uint16_t id) const = 0;

    virtual void load(const image::Image& image) = 0;
    /// Runs everything that starts before `until`; early only at a stop address.
    virtual void run_until(cosim::Time until) = 0;
    virtual void uart_receive(int unit, const cosim::UartFrame& frame) = 0;
    /// A bus master may address it: an `--i2c` script makes sense.
    virtual bool is_i2c_slave() const = 0;
    /// A phase of a bus master begins now; each but Stop is answered through TargetListener::i2c_answered().
    virtual void i2c_slave_phase(const cosim::I2cPhase& phase) = 0;
    /// No answer comes before this; kNever while none is awaited.
    virtual cosim::Time earliest_i2c_answer() const = 0;
    /// What the board adds to the report, as JSON text; empty: nothing.
    virtual std::string report() const { return {}; }
    /// What the bus with the devices on it adds once the run is over, as JSON text; empty: nothing.
    virtual std::string i2c_devices_report() const { return {}; }
    /// The run is over: logs are closed.
    virtual void finish() {}
    /// Of a target with a dsPIC. Throws std::logic_error elsewhere.
    virtual dspic::Chip& chip();

    // What the bench asks of any chip; without an override it is chip() that answers.
    virtual const cosim::ClockDomain& clock() { return chip().clock(); }
    /// How far the chip has been run.
    virtual cosim::Time now() { return chip().now(); }
    virtual std::uint32_t pc() { return chip().pc(); }
    virtual void stop_at(std::uint32_t pc) { chip().stop_at(pc); }
    /// run_until() returned early.
    virtual bool stopped() { return chip().stopped_at().has_value(); }
    virtual bool uart_enabled(int unit) { return chip().uart_enabled(unit); }
    virtual dspic::UartCounters uart_counters(int unit) { return chip().uart_counters(unit); }
    /// Resets so far, power-on included.
    virtual std::size_t resets() { return chip().resets(); }
    /// Reads a firmware file and checks that it fits `mcu`. Throws InputError.
    virtual image::Image read_image(const std::string& file, std::string_view mcu);
    /// cycles, instructions, resets and whatever else this kind of chip reports, as JSON text.
    virtual std::string chip_json();
    /// The same in lines for a person, warnings left out.
    virtual std::string chip_text();
    virtual std::vector<std::string> warnings();
    /// What the program waits for, once it has hung in one loop; nothing for a program that runs, or a chip
    /// whose loops nobody watches.
    virtual std::optional<std::string> hang();
    /// "main.c:12" of a program address, where the image states it; else empty.
    virtual std::string source_line(std::uint32_t /*pc*/) const { return {}; }
    /// Program addresses at which code of a source line begins.
    virtual std::vector<std::uint32_t> addresses_of(std::string_view /*file*/, std::uint32_t /*line*/) const {
        return {};
    }
    /// Source lines of the image that read_image() read; empty where it has none.
    virtual const image::LineTable& lines() const = 0;
    /// A pulse on the reset pin now.
    virtual void reset_button() { chip().mclr(); }
    /// load() with what `nvm` kept in place of the image's own, if it kept anything. Throws InputError.
    virtual void load_kept(const image::Image& image, const board::NvmFile& nvm);
    /// What the memories hold now goes to the file. Throws RunError.
    virtual void save_memory(board::NvmFile& nvm);

    /// The chip as a debugger sees it.
    virtual std::unique_ptr<debug::DebugChip> debug_chip();
    /// Whether save_state() and restore_state() work: not with devices on the bus.
    virtual bool saves() const { return false; }
    /// Everything that time changes of chip and surroundings, logs and stop addresses apart; between two
    /// run_until() of this very target.
    virtual void save_state(StateWriter& /*archive*/) {}
    virtual void restore_state(StateReader& /*archive*/) {}
    /// What happens from now on (until repeat(false)) has happened before, and goes to no log.
    virtual void repeat(bool /*on*/) {}
};

/// `mcu` as --mcu takes it; the chip alone, nothing connected. Throws InputError for an unknown name.
std::unique_ptr<Target> make_bare_chip(std::string_view mcu, const TargetOptions& options,
                                       TargetListener& listener);
/// `board` as --board takes it ("pic", "rab", "tam"). Throws InputError for an unknown name.
std::unique_ptr<Target> make_board(std::string_view board, const TargetOptions& options,
                                   TargetListener& listener);

std::unique_ptr<Target> make_avr_chip(std::string_view mcu, const TargetOptions& options,
                                      TargetListener& listener);
std::unique_ptr<Target> make_pic_target(const TargetOptions& options, TargetListener& listener);
std::unique_ptr<Target> make_rab_target(const TargetOptions& options, TargetListener& listener);
std::unique_ptr<Target> make_tam_target(const TargetOptions& options, TargetListener& listener);

/// What goes without saying for a chip or board.
struct TargetDefaults {
    std::string_view mcu;
    double crystal_hertz = 0;
    std::array<double, 2> baud{115200, 115200};  ///< of the bench's ends
    std::optional<std::uint16_t> fosc;  ///< configuration word in force on the robot; none: the image's
};
/// The board ("pic") whose chip a firmware file is for. Throws InputError: a scenario, none, or several.
std::string board_for(const std::string& image);
/// One of the two is empty, as on the command line. Throws InputError for an unknown name.
TargetDefaults defaults_of(std::string_view mcu, std::string_view board);

}  // namespace puckloop::exec
