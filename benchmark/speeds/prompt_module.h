#pragma once
// A radio module as a TAM's firmware sees it, without radio: answers every AT command and acknowledges what
// is sent, at once. For measurements, on any emulator.

#include "protocols/radio/xbee_frame.h"

#include <cstdint>
#include <vector>

namespace puckloop::tools {

class PromptModule {
  public:
    /// What it sends when it comes out of reset.
    static std::vector<std::uint8_t> hello();
    /// A byte from the firmware: the bytes of its answer, if there is one.
    std::vector<std::uint8_t> take(std::uint8_t byte);

  private:
    protocols::XBeeReader reader_{protocols::XBeeApiMode::Escaped};
};

}  // namespace puckloop::tools
