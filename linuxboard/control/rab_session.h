#pragma once
// Everything puckloop-control does with a real range-and-bearing board, from its bus to the lines it prints.

#include "linuxboard/control/behaviours/neighbours.h"
#include "linuxboard/control/devices/posix_i2c.h"
#include "linuxboard/control/options.h"

namespace puckloop::control {

class RabSession {
  public:
    using Log = std::function<void(const std::string&)>;

    /// Opens the bus. Throws std::runtime_error naming it.
    RabSession(const Options& options, Clock& clock, Log log);

    /// Sets the board up; false when it does not answer.
    bool set_up() { return link_.initialise(); }
    /// The same, and starts its threads.
    bool start();
    /// With a board that is set up. Puts a calibration's result on standard output; 0, or 1 when too few
    /// messages came.
    int calibrate(const Options& options, const std::function<bool()>& interrupted);

    std::vector<Neighbour> neighbours();
    void say(std::uint32_t data);
    void report() const;
    int last_error() const { return board_.last_error(); }

  private:
    int id_;
    Clock& clock_;
    Log log_;
    PosixI2c device_;
    RabBoard board_;
    RabLink link_;
    Neighbourhood neighbourhood_;
};

}  // namespace puckloop::control
