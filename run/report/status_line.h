#pragma once
// One line on the terminal that shows how far a run is; nothing in a pipe.

#include "cosim/conductor.h"

#include <optional>

namespace puckloop::tools {

class StatusLine {
  public:
    /// `duration` in seconds, if the run has one.
    explicit StatusLine(std::optional<double> duration);
    ~StatusLine();
    StatusLine(const StatusLine&) = delete;
    StatusLine& operator=(const StatusLine&) = delete;

    void show(const cosim::Progress& progress);
    /// Removes the line, before other output.
    void clear();

  private:
    std::optional<double> duration_;
    bool on_terminal_;
    bool shown_ = false;
};

}  // namespace puckloop::tools
