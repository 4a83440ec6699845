#pragma once
// Single-instruction cases as text: one line holds a machine state and the words to execute, the answer is
// the state afterwards. What `puckloop step --mcu atmega1284p` speaks.
//
//   <id> r=R0,..,R31 pc= op=word,.. [sr= sp= rz= m=address:byte,.. p=address:word,.. run=N]     all hex, run
//   decimal <id> ok r=.. sr= sp= rz= pc= m=<changed bytes> cyc=<n> <id> unsupported <why>      <id> error
//   <what is wrong with the line>
//
// pc and p count bytes, as avr-gcc's symbols do, and are even. m takes RAM and GPIOR0..2 (003e, 004a, 004b).

#include "emu/avr/devices/device.h"

#include <memory>
#include <string>
#include <string_view>

namespace puckloop::avr {

class StepMachine {
  public:
    explicit StepMachine(const DeviceInfo& device);
    ~StepMachine();

    /// The answer to one line, without a line end. Never throws for what a line contains.
    std::string answer(std::string_view line);

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace puckloop::avr
