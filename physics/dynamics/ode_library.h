#pragma once
// ODE as a library: started once, given where its messages go, prepared for each thread that steps a world.

#include <cstdint>
#include <string>

namespace puckloop::physics {

/// ODE's messages of one world.
struct OdeWarnings {
    std::uint64_t count = 0;
    std::string first;
};

/// While it lives, this thread may call ODE and what ODE reports goes to `ode_warnings`; errors that ODE
/// calls fatal are thrown as RunError.
class OdeSession {
  public:
    explicit OdeSession(OdeWarnings& ode_warnings);
    ~OdeSession();
    OdeSession(const OdeSession&) = delete;
    OdeSession& operator=(const OdeSession&) = delete;

  private:
    OdeWarnings* previous_;
};

}  // namespace puckloop::physics
