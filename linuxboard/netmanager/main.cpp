// puckloop-netmanager: passes messages between robots' clients by TCP, on a real network as well as on an
// emulated one. docs/network.md
//
// Exit status: 0 ended by a signal; 2 wrong use, or a port or file that cannot be opened.

#include "linuxboard/netmanager/manager.h"

#include <boost/asio/ip/address_v4.hpp>
#include <boost/asio/signal_set.hpp>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <getopt.h>
#include <stdexcept>

namespace {

using namespace puckloop::netmanager;

constexpr char kUsage[] =
    "usage: puckloop-netmanager [--port N] [--control N] [--range M] [--hops N] [--hop-delay S]\n"
    "                           [--loss P] [--seed N] [--robot ADDRESS=NUMBER]... [--log FILE]\n"
    "                           [--status S]\n"
    "  --port N           to listen at (7700)\n"
    "  --range M          largest distance of one hop, m, by the positions in robots' messages (no limit)\n"
    "  --hops N           most hops of a message (1)\n"
    "  --hop-delay S      a message is passed on so many seconds later for each hop (0)\n"
    "  --loss P           chance that a message is lost on its way to one robot (0)\n"
    "  --seed N           of what is lost (1)\n"
    "  --control N        UDP port for changes of these while it runs, one for each datagram (7701; 0: "
    "none):\n"
    "                     range M, hops N, delay S, loss P [FROM TO], show; answered with the status\n"
    "  --robot A=N        the robot at address A has number N; others the last part of their address\n"
    "  --log FILE         a table of events (CSV)\n"
    "  --status S         print settings, links and last messages after changes, at most each S seconds (0: "
    "not)\n";

constexpr int kWrongUse = 2;

[[noreturn]] void refuse(const std::string& what) {
    std::fprintf(stderr, "puckloop-netmanager: %s\n", what.c_str());
    std::exit(kWrongUse);
}

template <typename T>
T number(const char* option, std::string_view text, T low, T high) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value >= low && value <= high))
        refuse(std::string(option) + ": '" + std::string(text) + "' is no number from " +
               std::to_string(low) + " to " + std::to_string(high));
    return value;
}

void add_robot(Options& options, std::string_view text) {
    const std::size_t equals = text.find('=');
    boost::system::error_code error;
    const std::string address(text.substr(0, equals));
    boost::asio::ip::make_address_v4(address, error);
    if (equals == std::string_view::npos || error)
        refuse("--robot: '" + std::string(text) + "' is not ADDRESS=NUMBER, such as 10.0.0.7=12");
    options.numbers[address] = number("--robot", text.substr(equals + 1), 0, kMostNumber);
}

enum { kPort = 1, kControl, kRange, kHops, kHopDelay, kLoss, kSeed, kRobot, kLog, kStatus, kHelp };

Options read_options(int count, char** words) {
    const option known[] = {
        {"port", 1, nullptr, kPort},     {"control", 1, nullptr, kControl},    {"range", 1, nullptr, kRange},
        {"hops", 1, nullptr, kHops},     {"hop-delay", 1, nullptr, kHopDelay}, {"loss", 1, nullptr, kLoss},
        {"seed", 1, nullptr, kSeed},     {"robot", 1, nullptr, kRobot},        {"log", 1, nullptr, kLog},
        {"status", 1, nullptr, kStatus}, {"help", 0, nullptr, kHelp},          {nullptr, 0, nullptr, 0}};
    Options options;
    const auto microseconds = [](const char* name, double low, double high) {
        return std::chrono::microseconds(std::llround(number(name, optarg, low, high) * 1e6));
    };
    for (int one; (one = getopt_long(count, words, "", known, nullptr)) != -1;) {
        switch (one) {
        case kPort:
            options.port = static_cast<std::uint16_t>(number("--port", optarg, 1, 65'535));
            break;
        case kControl:
            options.control = static_cast<std::uint16_t>(number("--control", optarg, 0, 65'535));
            break;
        case kLoss:
            options.settings.loss = number("--loss", optarg, 0.0, 1.0);
            break;
        case kSeed:
            options.seed = number("--seed", optarg, std::uint64_t{0}, ~std::uint64_t{0});
            break;
        case kStatus:
            options.status_every = microseconds("--status", 0.0, 3600.0);
            break;
        case kRange:
            options.settings.limits.range = number("--range", optarg, 0.0, kFarthest);
            break;
        case kHops:
            options.settings.limits.hops = number("--hops", optarg, 1, kMostNumber);
            break;
        case kHopDelay:
            options.settings.hop_delay = microseconds("--hop-delay", 0.0, kLongestDelay);
            break;
        case kRobot:
            add_robot(options, optarg);
            break;
        case kLog:
            options.log = optarg;
            break;
        case kHelp:
            std::fputs(kUsage, stdout);
            std::exit(0);
        default:
            std::fputs(kUsage, stderr);
            std::exit(kWrongUse);
        }
    }
    if (optind < count) refuse(std::string("'") + words[optind] + "' is not an option");
    return options;
}

}  // namespace

int main(int count, char** words) {
    const Options options = read_options(count, words);
    try {
        boost::asio::io_context io;
        boost::asio::signal_set signals(io, SIGINT, SIGTERM);
        signals.async_wait([&io](boost::system::error_code, int) { io.stop(); });
        Manager manager(io, options);
        io.run();
    } catch (const std::runtime_error& error) {
        refuse(error.what());
    }
    return 0;
}
