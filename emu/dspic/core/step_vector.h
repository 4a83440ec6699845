#pragma once
// Single-instruction cases as text: one line holds a machine state and the words to execute, the answer is
// the state afterwards. What `puckloop step` speaks.
//
//   <id> w=W0,..,W15 pc= op=word,.. [sr= cc= aa= ab= rc= tp= ps= dc= ds= de= di= sh=W0,W1,W2,W3,SR
//        m=address:word,.. p=address:word,.. run=N]                                   all hex, run decimal
//   <id> ok w=.. sr= cc= aa= ab= rc= pc= tp= ps= dc= ds= de= di= sh= m=<changed words> cyc=<n>
//   <id> unsupported <why>      <id> error <what is wrong with the line>

#include "emu/dspic/devices/device.h"

#include <memory>
#include <string>
#include <string_view>

namespace puckloop::dspic {

class StepMachine {
  public:
    /// `twice`: each case is executed once, set up again and executed from operations that are decoded, which
    /// a core that translates at the first arrival then does translate.
    explicit StepMachine(const DeviceInfo& device, bool twice = false);
    ~StepMachine();

    /// The answer to one line, without a line end. Never throws for what a line contains.
    std::string answer(std::string_view line);

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace puckloop::dspic
