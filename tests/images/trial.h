#pragma once
// One row of the table of images: a real image with its selector at a position, what is done to it, and what
// it then does. Source of what it should do: the e-puck library's programs (docs/images.md names them).

#include "tests/exec/rig.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::images {

/// An image on the bench, booted.
class Trial {
  public:
    struct Setup {
        std::string board = "pic";
        int selector = 0;
        pic::Revision revision = pic::Revision::Rev12;
        double boot = 3.8;        ///< s until it listens
        double uart2_baud = 0.0;  ///< of the bench's end; 0: the board's usual one
    };
    Trial(const std::string& image_file, const Setup& setup);

    exec::Rig& rig() { return *rig_; }
    void set(const std::string& signal, double value) { rig_->set(signal, value); }
    void run(double seconds) { rig_->run_for(seconds); }
    /// What comes back at UART `unit` within `seconds` of `text`.
    std::string ask(const std::string& text, int unit = 1, double seconds = 0.15);
    /// A key of a remote control, pressed once: one RC5 frame, and rest until the next could come.
    void press(int key, int address);
    /// All that came at `unit` since the last call, that of the boot included.
    std::string heard(int unit = 1) { return rig_->take_text(unit); }
    /// "0 7 6": the ring's LEDs that are on.
    std::string leds();
    /// Steps of a wheel in the next `seconds`: left, right.
    std::array<double, 2> drives(double seconds);
    /// Largest size of what drives the speaker in the next `seconds`, 1 is full scale.
    double plays(double seconds);
    /// Words of a report that keeps it from working: traps, unmodelled registers. Empty: none.
    std::string troubles();

  private:
    std::unique_ptr<exec::Rig> rig_;
    bool toggle_ = false;  // of the remote control
};

struct Row {
    std::string image, at;  ///< selector or command
    std::string says;       ///< what the source states
    Trial::Setup setup;
    /// What was seen, in words that hold for each run; throws Wrong where it was something else.
    std::function<std::string(Trial&)> see;
};

/// It does something else than its source states.
struct Wrong {
    std::string seen;
};
/// Throws Wrong unless `right`.
void expect(bool right, const std::string& seen);

/// A remote control drives the robot: keys 2 (ahead), 5 (stop), 4 (left), 0 (a sound).
std::string drives_by_remote(Trial& trial);

/// The accelerometer's lowest side, on an LED.
std::string shows_the_ground(Trial& trial);

/// A clap of 20 ms at all microphones: an LED shows a direction, the robot turns to it.
std::string locates_a_clap(Trial& trial);

std::vector<Row> demo_gctronic_rows();
std::vector<Row> demo_rows();
std::vector<Row> btcom_rows();
std::vector<Row> other_rows();

}  // namespace puckloop::images
