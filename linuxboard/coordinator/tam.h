#pragma once
// One TAM as controllers see it: what it last reported, and what it is wished to do. Wishes are kept until
// the TAM has followed them; who sends is the Coordinator (coordinator.h).

#include "linuxboard/coordinator/color.h"
#include "protocols/radio/xbee_message.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace puckloop::coordinator {

/// A state report: what a TAM sends when something changed, and every 10 s.
struct Report {
    Color leds;                   ///< as commanded
    bool robot = false;           ///< a robot is inside
    int battery_mv = 0;           ///< mV
    std::uint8_t robot_byte = 0;  ///< the last byte that came by infra-red
    bool operator==(const Report&) const = default;
};

/// Of the radio payload; nothing if it is no report.
std::optional<Report> parse_report(const protocols::XBeeBytes& payload);

class Tam {
  public:
    /// Writes an event of this TAM to the table: event, value, detail.
    using Note = std::function<void(const std::string&, const std::string&, const std::string&)>;

    static constexpr double kSetLedsTimeout = 3.0;     ///< s
    static constexpr double kWriteRobotTimeout = 5.0;  ///< s
    static constexpr double kRetry = 1.0;              ///< s after a failed delivery
    static constexpr double kSilence = 25.0;           ///< s without a report: lost

    Tam(std::string name, std::uint64_t address, Note note)
        : name_(std::move(name)), address_(address), note_(std::move(note)) {}

    // --- for controllers ---------------------------------------------------
    const std::string& name() const { return name_; }  ///< "TAM07"
    /// Nothing before the first report.
    const std::optional<Report>& report() const { return report_; }
    bool robot() const { return report_ && report_->robot; }
    /// The last report has this colour.
    bool shows(Color color) const { return report_ && report_->leds == color; }
    /// No report for kSilence.
    bool lost() const { return lost_; }
    /// The LEDs should have this colour.
    void set_leds(Color color) { color_ = color; }
    /// The byte the TAM sends to robots inside, again and again.
    void write_robot(std::uint8_t byte) { byte_ = byte; }
    /// The TAM switches itself off, for good.
    void shut_down() { shut_down_ = true; }
    /// An event of the controller's own.
    void note(const std::string& event, const std::string& value, const std::string& detail = {}) const {
        note_(event, value, detail);
    }

    // --- for the coordinator -----------------------------------------------
    std::uint64_t address() const { return address_; }
    /// The module was replaced: another address, and nothing known.
    void move_to(std::uint64_t address);
    void take_report(const Report& report, double now);
    /// The fate of the frame `id` (XBeeTxStatus).
    void take_status(std::uint8_t id, std::uint8_t delivery, double now);
    /// Time-outs.
    void pass_time(double now);
    /// A payload that is to be sent now, if any; `sent` must follow.
    std::optional<protocols::XBeeBytes> next_request(double now) const;
    void sent(const protocols::XBeeBytes& payload, std::uint8_t id, double now);
    /// The last report has the colour that is wished, and nothing else was sent since.
    bool settled() const { return color_ && shows(*color_) && !unsure_; }
    /// The colour is sent whatever the last report states.
    void confirm_leds() {
        unsure_ = true;
        set_leds_ = {};
    }

  private:
    struct Command {
        bool outstanding = false;
        std::uint8_t id = 0;
        double since = 0;       ///< s
        double not_before = 0;  ///< s
    };

    std::string name_;
    std::uint64_t address_;
    Note note_;
    std::optional<Report> report_;
    double heard_ = 0;
    int battery_noted_ = 0;  ///< mV
    bool lost_ = false;
    std::optional<Color> color_;
    std::optional<std::uint8_t> byte_, written_;
    bool shut_down_ = false;
    std::uint8_t byte_sent_ = 0;
    Color color_sent_{};
    bool unsure_ = false;  ///< a colour was sent that no report has answered
    Command set_leds_, write_robot_;
};

}  // namespace puckloop::coordinator
