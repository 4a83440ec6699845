#pragma once
// Range and bearing performed again: new pairs of emulated boards at the measured distances, in poses of
// their own, first as the simulator is, then with the verdict's overlay. Compared are means of groups -
// strength by distance and nearest receiver, bearing's error by nearest receiver -, the scatter about them,
// and the shares received. Messages of single emitters are left out. Where the measured hosts polled at their
// own pace (an `arrival_rate` above 0), frames come at that rate again, and polls with the time that the
// verdict found between them (`rab.fetch_time`); else each message is waited for.
//
// Deviations: 1. boards alone in the world, one sender. 2. Each pair has its own spread of parts, which
// counts as error in both.

#include "selftest/emulate/rerun.h"

namespace puckloop::gap::emulate {

/// As rerun(), for an experiment of kind rab.
Rerun rerun_rab(const Experiment& experiment, const Verdict& verdict, const RerunOptions& options);

}  // namespace puckloop::gap::emulate
