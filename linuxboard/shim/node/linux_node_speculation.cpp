// Running ahead while the program waits. Until one of its calls ends, a signal is due or the like, nothing
// changes but the serial port and the I2C adapter, of which a copy is the mark: so a transfer goes phase by
// phase, and what comes in by the serial port collects, on what is only foreseen.

#include "base/error.h"
#include "linuxboard/shim/node/linux_node.h"

#include <algorithm>

namespace puckloop::linuxboard {

using cosim::Message;
using cosim::Time;

/// What faults, cameras and a network have done is not taken back; in real time the wall clock is not.
bool LinuxNode::can_foresee() const {
    return faults_.empty() && spec_.cameras.empty() && !spec_.network && !spec_.real_time;
}

void LinuxNode::must_be_final() const {
    if (speculation_ && speculation_->marked())
        throw RunError("the program would go on at a time that is not yet sure");
}

void LinuxNode::Speculation::mark() {
    node_.kernel_.copy_devices(devices_);
    until_ = node_.until_;
    messages_in_ = node_.messages_in_;
    marked_ = true;
}

void LinuxNode::Speculation::rewind() {
    node_.action_.reset();
    node_.kernel_.put_back(*devices_);
    node_.until_ = until_;
    node_.messages_in_ = messages_in_;
    node_.inbox_.clear();
    node_.inbox_next_ = 0;
}

Time LinuxNode::Speculation::horizon(std::span<const Message> next) const {
    if (node_.kernel_.has_finished()) return node_.until_;
    Time first = std::min(node_.next_scheduled(), node_.kernel_.next_wake(next));
    for (const auto& client : node_.clients_) {
        if (client->state == Client::State::Starting) return node_.until_;
        first = std::min(first, node_.goes_on(*client));
    }
    return std::max(first, node_.until_);
}

}  // namespace puckloop::linuxboard
