#pragma once
// An XB24-DMWIT-250 radio module (XBee Series 1 with DigiMesh 2.4 firmware): API frames and transparent data
// on its serial line, AT commands, discovery, what it sends and gets over the air. Network layer and MAC are
// the medium's (emu/radio).
// Sources: TAM fact sheet, sections 6 and 10; XBee/XBee-PRO DigiMesh 2.4 manual (90000991), "Operate in API
// mode", "AT commands", "Transparent operating mode", "Network discovery".
//
// Deviations:
// 1. A command or frame takes a fixed time (`processing`), the start after reset another (`boot`); the manual
//    gives neither.
// 2. Frames 11 (explicit addressing) and 95 (node identification) are not there; synchronised sleep (SM = 7,
// 8), encryption
//    (EE), analog and digital lines have no effect. Asking for them is answered and counted.
// 3. At most four packets wait for their fate; then the serial line waits.
// 4. DN is answered with the status 0x40 that the TAM's firmware needs, as is ND.
// 5. FR resets 100 ms after its answer, with modem status 1.
// 6. A module that wakes up hears at once, and has forgotten its routes.
// 7. In command mode data from the air waits, as far as it fits into the buffer, until the host leaves.

#include "base/fields/field.h"
#include "base/random.h"
#include "cosim/core/message.h"
#include "cosim/core/seconds_form.h"
#include "emu/radio/control.h"
#include "emu/xbee/module_counts.h"
#include "emu/xbee/serial_out.h"
#include "emu/xbee/settings.h"
#include "protocols/radio/mesh_frame.h"
#include "protocols/radio/xbee_frame.h"
#include "protocols/radio/xbee_message.h"

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::xbee {

/// 64 bits as 16 hex digits.
struct HexAddress {
    static JsonValue write(std::uint64_t address);
    static void read(std::uint64_t& address, const JsonValue& from, const std::string& place);
};
/// An object: {"AP": 2}.
struct FlashParameters {
    using List = std::vector<std::pair<std::string, std::uint32_t>>;
    static JsonValue write(const List& parameters);
    static void read(List& parameters, const JsonValue& from, const std::string& place);
};

struct ModuleOptions {
    std::string name = "xbee";
    std::uint64_t seed = 1;
    std::uint64_t address = 0x0013A20040000000;
    std::vector<std::pair<std::string, std::uint32_t>> parameters{};
    std::string node_identifier = " ";
    cosim::Time start = 0;
    cosim::Time boot = 50 * cosim::kMillisecond;
    cosim::Time processing = cosim::kMillisecond;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("name", &ModuleOptions::name, "of the node; the random stream is \"<name>/discovery\""),
            field("seed", &ModuleOptions::seed, "of the run"),
            field("address", &ModuleOptions::address, "SH and SL").as<HexAddress>(),
            field("parameters", &ModuleOptions::parameters,
                  "what was written into its flash: commands with values, in the range of the table")
                .as<FlashParameters>(),
            field("node_identifier", &ModuleOptions::node_identifier, "NI, its name on the mesh"),
            field("start_s", &ModuleOptions::start, "switched on").in("s").at_least(0).as<cosim::Seconds>(),
            field("boot_s", &ModuleOptions::boot, "from reset to modem status, not below processing_s")
                .in("s")
                .above(0)
                .as<cosim::Seconds>(),
            field("processing_s", &ModuleOptions::processing, "of a frame from either side")
                .in("s")
                .above(0)
                .as<cosim::Seconds>());
    }
};
static_assert(lists_all_fields<ModuleOptions>);

/// Where a module's radio leads.
class ModuleAir {
  public:
    virtual ~ModuleAir() = default;
    /// A frame for the network layer, or settings (`on_air` 0).
    virtual void radio_sent(std::vector<std::uint8_t> octets, cosim::Time on_air, cosim::Time now) = 0;
    /// CTS, active low, changed.
    virtual void cts_changed(bool level, cosim::Time now) = 0;
};

/// Inputs come in order of time, each after run_until() of that time.
class Module {
  public:
    /// Throws InputError for parameters that no module accepts.
    Module(const ModuleOptions& options, ModuleAir& air);
    Module(const Module&) = delete;
    Module& operator=(const Module&) = delete;

    void byte_received(std::uint8_t byte, cosim::Time at);
    void framing_error() { ++counts_.framing_errors; }
    void radio_received(const cosim::RadioFrame& frame, cosim::Time now);
    void reset_pin(bool asserted, cosim::Time now);
    void power(bool on, cosim::Time now);
    /// The level of RTS: high holds DOUT back where D6 = 1.
    void rts(bool level, cosim::Time now);

    /// The level of SLEEP_RQ (pin 9).
    void sleep_request(bool level, cosim::Time now);

    /// Everything that is due until then, inclusive.
    void run_until(cosim::Time until);
    cosim::Time next_task() const { return tasks_.empty() ? cosim::kNever : tasks_.begin()->first; }
    /// Nothing leaves for the air before, if nothing comes in.
    cosim::Time next_radio() const;
    /// No byte that is still unknown begins before, if nothing comes in.
    cosim::Time next_byte() const;
    SerialOut& serial() { return out_; }
    const SerialOut& serial() const { return out_; }
    const Settings& settings() const { return settings_; }
    const ModuleCounts& counts() const { return counts_; }
    /// Bit time that its receiver samples with.
    cosim::Time receiver_bit() const { return out_.bit_period(); }
    const ModuleOptions& options() const { return options_; }

  private:
    enum class TaskKind : std::uint8_t {
        Byte,
        Input,
        Boot,
        Answer,
        DiscoveryEnd,
        RemoteEnd,
        PacketEnd,
        Packetize,
        Quiet,
        Restart,
        Rts,
        RadioOff,
        Heard,
        Fate,
        Baud,
        Guard,
        CommandLine,
        CommandTimeout,
        SleepPin,
        Sleep,
        Wake
    };
    struct Task {
        TaskKind kind = TaskKind::Byte;
        std::uint64_t value = 0;
        protocols::MeshFrame frame{};  ///< Answer, Heard
        radio::RadioOutcome fate{};    ///< Fate
    };
    /// An ND or DN that is under way.
    struct Discovery {
        std::uint16_t sequence = 0;
        std::uint8_t id = 0;
        bool single = false;  ///< DN
        bool text = false;    ///< asked in command mode
    };
    struct Packet {
        std::uint8_t id = 0;
    };
    struct Remote {
        std::uint8_t id = 0;
        std::uint64_t to = 0;
        protocols::XBeeCommand command{};
    };
    /// What a command does beside its status and value.
    struct AtResult {
        std::uint8_t status = kAtOk;
        protocols::XBeeBytes value;
        bool answered_later = false;
    };

    void add(cosim::Time at, Task task) { tasks_.emplace(at, std::move(task)); }
    void run_task(const Task& task, cosim::Time now);
    void forget_everything();
    void boot(std::uint8_t status, cosim::Time now);
    void tell_radio(bool on, cosim::Time now);
    void apply(cosim::Time now);
    protocols::XBeeApiMode api_mode() const;
    void new_reader(protocols::XBeeApiMode mode);

    // Serial side (module_serial.cpp).
    void byte(std::uint8_t value, cosim::Time now);
    void api_byte(std::uint8_t value, cosim::Time now);
    void schedule_input(cosim::Time now);
    void handle(const protocols::XBeeMessage& message, cosim::Time now);
    void packetize(cosim::Time now);
    void update_cts(cosim::Time now);
    bool to_host(const protocols::XBeeMessage& message, cosim::Time now);

    // AT commands (module_at.cpp).
    AtResult at(const protocols::XBeeCommand& command, const protocols::XBeeBytes& value, std::uint8_t id,
                cosim::Time now);
    AtResult act(const std::string& command, const protocols::XBeeBytes& value, std::uint8_t id,
                 cosim::Time now, bool& known);
    void discover(bool single, const protocols::XBeeBytes& identifier, std::uint8_t id, cosim::Time now);

    // Command mode (module_command.cpp).
    void text_to_host(std::string_view text, cosim::Time now);
    bool guarded(std::uint8_t value, cosim::Time now);
    void guard_over(cosim::Time now);
    void stay_in_command_mode(cosim::Time now);
    void leave_command_mode(cosim::Time now);
    void keep_for_later(const protocols::XBeeBytes& data);
    void command_byte(std::uint8_t value, cosim::Time now);
    void command_line(const std::string& line, cosim::Time now);
    void command(std::string_view words, cosim::Time now);
    void discovered_in_command_mode(const Discovery& discovery, std::uint64_t address,
                                    const std::string& identifier, cosim::Time now);
    void discovery_over_in_command_mode(const Discovery& discovery, cosim::Time now);

    // Sleep (module_sleep.cpp).
    bool sleeps_cyclically() const;
    bool wants_sleep() const;
    void consider_sleep(cosim::Time now);
    void stay_awake(cosim::Time now);
    void fall_asleep(cosim::Time now);
    void wake_up(cosim::Time now);

    // Air side (module_air.cpp).
    std::uint16_t send(protocols::MeshKind kind, std::uint64_t to, std::uint8_t options, std::uint8_t radius,
                       protocols::XBeeBytes data, cosim::Time now);
    void transmit(const protocols::XBeeTx& tx, cosim::Time now);
    void outcome(const radio::RadioOutcome& outcome, cosim::Time now);
    void fate(const radio::RadioOutcome& fate, cosim::Time now);
    void frame_received(const protocols::MeshFrame& frame, cosim::Time at);
    void heard(const protocols::MeshFrame& frame, cosim::Time now);
    void asked_to_show_itself(const protocols::MeshFrame& frame, cosim::Time now);
    void discovered(const protocols::MeshFrame& frame, cosim::Time now);
    void remote_at(const protocols::MeshFrame& frame, cosim::Time now);
    void remote_answer(const protocols::MeshFrame& frame, cosim::Time now);
    protocols::XBeeBytes description(std::uint64_t address, const std::string& identifier) const;

    ModuleOptions options_;
    ModuleAir& air_;
    Settings settings_;
    SerialOut out_;
    cosim::Time bit_ = 0;  ///< of the parameters in force; the line follows
    ModuleCounts counts_;
    RandomStream discovery_random_;
    std::multimap<cosim::Time, Task> tasks_;
    bool powered_ = false, in_reset_ = false, up_ = false;
    bool cts_ = false, rts_ = false;
    bool asleep_ = false, sleep_request_ = false;
    std::uint64_t sleep_turn_ = 0;  ///< Sleep and Wake tasks of an earlier one are void

    std::optional<radio::RadioSettings> announced_;  ///< what the medium knows
    protocols::XBeeApiMode reader_mode_ = protocols::XBeeApiMode::Plain;
    protocols::XBeeReader reader_{protocols::XBeeApiMode::Plain};
    std::size_t partial_bytes_ = 0;  ///< on the line since the last frame; the parser holds them
    std::size_t waiting_bytes_ = 0;  ///< in the serial receive buffer: of frames that are not handled
    std::deque<std::pair<protocols::XBeeMessage, std::size_t>> waiting_;  ///< with their bytes on the line
    bool input_scheduled_ = false;
    protocols::XBeeBytes plain_;    ///< transparent data
    std::uint64_t last_byte_ = 0;   ///< counts bytes: a Quiet or Guard task of an earlier one is void
    cosim::Time last_byte_at_ = 0;  ///< its end; the silence before "+++"
    int plus_ = 0;                  ///< characters of what may be "+++", not yet data
    bool command_mode_ = false;
    std::string line_;                                   ///< that is coming in
    std::deque<std::string> lines_;                      ///< of CommandLine tasks
    std::uint64_t command_turn_ = 0;                     ///< a CommandTimeout of an earlier command is void
    std::vector<protocols::XBeeBytes> heard_meanwhile_;  ///< data from the air; the host gets it afterwards

    std::uint16_t sequence_ = 0;  ///< 15 bits; goes on after a reset
    std::map<std::uint16_t, Packet> packets_;
    std::vector<Discovery> discoveries_;
    std::map<std::uint16_t, Remote> remotes_;
    std::uint8_t last_dbm_ = 0;  ///< DB: minus dBm of the last packet
};

}  // namespace puckloop::xbee
