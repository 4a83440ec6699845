#pragma once
// TCP's states as Linux numbers them (include/net/tcp_states.h).

#include "linuxboard/shim/network/tcp_connection.h"

#include <netinet/tcp.h>

#include <utility>

namespace puckloop::linuxboard {

constexpr int number_of(TcpConnection::State state) {
    using State = TcpConnection::State;
    constexpr std::pair<State, int> kStates[] = {
        {State::Closed, TCP_CLOSE},         {State::SynSent, TCP_SYN_SENT},
        {State::SynReceived, TCP_SYN_RECV}, {State::Established, TCP_ESTABLISHED},
        {State::FinWait1, TCP_FIN_WAIT1},   {State::FinWait2, TCP_FIN_WAIT2},
        {State::CloseWait, TCP_CLOSE_WAIT}, {State::Closing, TCP_CLOSING},
        {State::LastAck, TCP_LAST_ACK},     {State::TimeWait, TCP_TIME_WAIT}};
    for (const auto& [known, number] : kStates)
        if (known == state) return number;
    return TCP_CLOSE;
}

}  // namespace puckloop::linuxboard
